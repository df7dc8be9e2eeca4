"""A guess whose answer, a mean of the solutions, depends on their order and number."""


class Guess:
    def __init__(self, rods, options):
        self.known = {}

    def propose(self, system):
        return self.known.get((system.rod, system.newton))

    def accept(self, system, x):
        place = system.rod, system.newton
        self.known[place] = 0.5 * (self.known.get(place, x) + x)

    def accept_total(self, rod, step, x):
        self.known[rod, 0] = x
