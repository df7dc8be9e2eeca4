"""The report in a browser: no console errors, no requests, and all controls work."""

import os
import re
import sys
import tempfile
import unittest

import synthetic
from browser import DRIVER, Browser

import trajectories
from running import run

SIZES = {"desktop": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844, "phone": True}}
CHART = '.explorer .chart [role="application"]'


class Page(unittest.TestCase):
    sweep = {"samples": 6}

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.page, sweep = (os.path.join(folder.name, name) for name in ("page.html", "sweep.h5"))
        synthetic.Sweep(steps=2, **cls.sweep).write(sweep)
        trajectories.plant(sweep, frames=20)
        done = run("report.py", sweep, "-o", cls.page)
        assert done.code == 0, done.stderr
        cls.browser = cls.enterClassContext(Browser())

    def setUp(self):
        self.browser.open(self.page)

    def js(self, code):
        return self.browser.run(code)

    def texts(self, selector):
        return self.js(f"[...document.querySelectorAll({selector!r})]"
                       ".map(one => (one.innerText ?? one.textContent).trim().replace(/\\s+/g, ' '))")

    def choose(self, label, value):
        """Selects a value in the list with this label, as a reader does."""
        self.js(f"""(() => {{
          const label = [...document.querySelectorAll('.explorer label')].find(one => one.innerText === {label!r});
          const select = document.getElementById(label.htmlFor);
          select.value = [...select.options].find(one => one.text === {value!r}).value;
          select.dispatchEvent(new Event('change', {{bubbles: true}}));
        }})()""")
        self.browser.settle()

    def labels(self):
        """The labels of the y axes."""
        return self.texts('.chart [aria-label="y-axis label"] text')

    def value_at(self, line, point, chart=0):
        """The value of a chart at a point: the height of the dot on the scale of the axis labels."""
        return self.js(f"""(() => {{
          const plot = document.querySelectorAll('.chart svg:not(.swatch)')[{chart}];
          const shift = (element) => Number(element.getAttribute('transform').match(/,\\s*([-\\d.]+)\\)/)[1]);
          const ticks = [...plot.querySelectorAll('[aria-label="y-axis tick label"] text')]
            .map(one => [shift(one), parseFloat(one.textContent)]);
          const [[y0, v0], [y1, v1]] = [ticks[0], ticks.at(-1)];
          const mark = plot.querySelectorAll('g[data-line="{line}"][aria-label="dot"] > *')[{point}];
          const y = mark.hasAttribute('cy') ? Number(mark.getAttribute('cy')) : shift(mark);
          const share = (y - y0) / (y1 - y0);
          return plot.querySelector('[data-log]') ? null : v0 + share * (v1 - v0);
        }})()""")


class Looks(Page):
    def test_it_complains_of_nothing_and_asks_for_nothing_in_any_size_and_theme(self):
        for (name, size), dark in ((one, dark) for one in SIZES.items() for dark in (False, True)):
            with self.subTest(size=name, dark=dark):
                self.browser.open(self.page, dark=dark, **size)
                self.assertEqual(self.browser.complaints(), [])
                self.assertEqual(self.browser.requests(), [f"file://{self.page}"])
                self.assertEqual(len(self.texts(CHART)), 2)
                self.assertLessEqual(self.js("document.scrollingElement.scrollWidth"), size["width"])

    def test_the_theme_is_the_systems_until_the_reader_chooses(self):
        def brightness():
            return self.js("getComputedStyle(document.body).backgroundColor.match(/[\\d.]+/g).slice(0, 3)"
                           ".reduce((sum, one) => sum + Number(one), 0) / 3")

        self.assertGreater(brightness(), 200)
        self.browser.click("#theme")
        self.assertLess(brightness(), 60)
        self.browser.open(self.page, dark=True)
        self.assertLess(brightness(), 60)
        self.browser.click("#theme")
        self.assertGreater(brightness(), 200)

    def test_texts_stand_out_from_what_is_behind_them_in_both_themes(self):
        for dark in (False, True):
            self.browser.open(self.page, dark=dark)
            weakest = self.js("""(() => {
              const channels = (colour) => colour.match(/[\\d.]+/g).map(Number);
              const light = ([r, g, b]) => [r, g, b].map(c => c / 255)
                .map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
                .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
              const behind = (one) => { for (; one; one = one.parentElement) {
                const colour = channels(getComputedStyle(one).backgroundColor);
                if (colour.length === 3) return colour; } return [255, 255, 255]; };
              const texts = 'main p, main td, main th, main b, main button, main label, main select';
              return Math.min(...[...document.querySelectorAll(texts)]
                .filter(one => one.innerText.trim() && !one.closest(':disabled')).map(one => {
                  const pair = [light(channels(getComputedStyle(one).color)), light(behind(one))].sort((a, b) => b - a);
                  return (pair[0] + 0.05) / (pair[1] + 0.05); }));
            })()""")
            self.assertGreater(weakest, 4.5)

    def test_on_paper_all_charts_and_tables_are_there_in_light_colours(self):
        self.browser.open(self.page, dark=True)
        self.js("""addEventListener('beforeprint', () => setTimeout(() => 0));
                   document.addEventListener('printing', () => { window.printed ??= {
                     charts: document.querySelectorAll('.chart svg:not(.swatch)').length,
                     open: [...document.querySelectorAll('details')].every(one => one.open)}; })""")
        self.assertEqual(self.browser.paper()[:4], b"%PDF")
        self.assertEqual(self.js("window.printed"), {"charts": 6, "open": True})    # ratios and two speedups of two scenes
        self.assertEqual(len(self.texts(CHART)), 2)
        self.assertFalse(self.js("document.querySelector('details').open"))


class Charts(Page):
    def test_dots_are_where_they_were_planted(self):
        for line, planted in ((1, 0.5), (2, 0.25), (3, 0.1)):
            self.assertAlmostEqual(self.value_at(line, 1), planted, delta=0.01)

    def test_every_control_changes_what_is_shown(self):
        self.browser.click('.explorer input[value="all"] + label')
        self.assertRegex(self.texts(".explorer [role=status]")[0], r"^CG ratio .*, 2 charts, 4 lines$")    # of the guesses
        self.assertAlmostEqual(self.value_at(1, 1), (0.5 + 2 * 0.9) / 3, delta=0.01)
        self.choose("Show", "CG iterations of a solve")
        self.assertAlmostEqual(self.value_at(0, 1), 20 * 20 * 1.01, delta=4)
        self.assertTrue(self.js("document.querySelector('.explorer input[value=\"all\"]').disabled"))
        self.choose("To the tolerance", "1e-1")
        self.assertAlmostEqual(self.value_at(0, 1), 20 * 20 * 1.1, delta=4)
        self.choose("Scene", "helix")
        self.assertEqual(self.texts(".chart figcaption"), ["Helix"])
        self.assertEqual(self.labels(), ["CG iterations of a solve"])
        self.choose("Over", "Young's modulus (Pa)")
        self.assertEqual(len(self.texts(CHART)), 6)     # two scenes with three numbers of segments each
        self.assertIn("number of segments N", self.texts(".explorer .filters label"))
        self.assertIn("over Young's modulus (Pa), 6 charts", self.texts(".explorer [role=status]")[0])

    def test_speedups_have_the_direct_solve_beside_them_and_say_what_they_are_of(self):
        self.choose("Show", "speedup of CG alone")
        self.browser.click(".explorer details summary")
        rows = {row.split()[0]: row for row in self.texts(".explorer .tables .wide:first-child tbody tr")}
        self.assertIn("4.00×", rows["quadratic"])
        self.assertEqual([float(x) for x in re.findall(r"(?<![\[ \d.]{2})\b([\d.]+)× \[", rows["direct"])], [1.25, 2.5, 5])
        self.assertIn("median over simulations", self.texts(".explorer .conditions")[0])
        self.assertEqual(self.labels(), 2 * ["speedup of CG alone (×)"])
        self.choose("Show", "time of the guess")
        self.assertEqual(self.labels(), 2 * ["time of the guess (µs)"])

    def test_guesses_are_switched_off_and_on(self):
        def lines():
            return self.js("new Set([...document.querySelectorAll('.chart g[data-line]')].map(g => g.dataset.line)).size")

        self.assertEqual(lines(), 3)
        self.browser.click(".legend .chip:nth-child(2)")
        self.assertEqual(lines(), 2)
        self.assertEqual(self.js("document.querySelector('.legend .chip:nth-child(2)').getAttribute('aria-pressed')"), "false")
        self.browser.click(".legend .chip:last-child")
        self.assertIn("choose a guess", self.texts(".explorer .charts")[0])
        self.browser.click(".legend .chip:nth-last-child(2)")
        self.assertEqual(lines(), 3)

    def test_pointing_at_a_chart_shows_values_with_their_intervals(self):
        for size in SIZES.values():
            self.browser.open(self.page, **size)
            left, top, width, height = self.browser.box(CHART)
            self.browser.move(left + width / 2 - 40, top + height / 2)
            said = self.texts(".readout:not([hidden])")
            self.assertEqual(len(said), 1)
            self.assertIn("number of segments N: 20", said[0])
            self.assertRegex(said[0], r"quadratic 0\.25 \[0\.2\d, 0\.2\d\]")
            self.assertIn("6 simulations", said[0])
            swatch = "document.querySelector('.readout:not([hidden]) .swatch').getBoundingClientRect().width"
            self.assertGreater(self.js(swatch), 20)
            self.browser.move(2, 2)
            self.assertEqual(self.texts(".readout:not([hidden])"), [])

    def test_a_tap_shows_values_that_stay_inside_a_small_screen(self):
        for screen in (360, 660):
            self.browser.open(self.page, width=screen, height=740, phone=True)
            for share, segments in ((0.15, 10), (0.5, 20), (0.95, 40)):
                with self.subTest(screen=screen, segments=segments):
                    left, top, width, height = self.browser.box(CHART)
                    self.browser.tap(left + share * width, top + height / 2)
                    self.assertIn(f"number of segments N: {segments}", self.texts(".readout:not([hidden])")[0])
                    left, right = self.js("(() => { const b = document.querySelector('.readout:not([hidden])')"
                                          ".getBoundingClientRect(); return [b.left, b.right]; })()")
                    self.assertGreaterEqual(left, 0)
                    self.assertLessEqual(right, screen)
                    self.assertLessEqual(self.js("document.scrollingElement.scrollWidth"), screen)
        left, top, *_ = self.browser.box(".explore h3")
        self.browser.tap(left + 5, top + 5)
        self.assertEqual(self.texts(".readout:not([hidden])"), [])

    def test_tables_sort_by_any_column_up_and_down(self):
        first = ".answer table tbody tr th"
        self.browser.click(".answer thead th:nth-child(2) button")
        self.assertEqual(self.texts(first)[:4], ["oracle(0.1)", "quadratic", "previous", "zero"])
        self.browser.click(".answer thead th:nth-child(2) button")
        self.assertEqual(self.texts(first)[:5], ["zero", "previous", "quadratic", "oracle(0.1)", "direct"])   # unknown last
        self.assertEqual(self.js("document.querySelector('.answer thead th:nth-child(2)').ariaSort"), "descending")
        self.browser.click(".answer thead th:first-child button")
        self.assertEqual(self.texts(first)[:3], ["direct", "oracle(0.1)", "previous"])


class NothingSwept(Page):
    sweep = {"scenes": ("helix",), "grid": {}, "random": {}, "samples": 1}

    def test_charts_are_over_the_scene_and_rows_have_their_swatches(self):
        self.assertEqual(self.browser.complaints(), [])
        self.assertEqual(self.texts(".explorer .control select option:checked")[:2], ["CG ratio", "type"])
        self.assertEqual(len(self.texts(CHART)), 1)
        self.assertAlmostEqual(self.value_at(2, 0), 0.25, delta=0.01)
        self.assertEqual(self.js("[...document.querySelectorAll('.answer .swatch')].map(one => one.children.length > 0)"),
                         [True] * 5)


class Access(Page):
    def test_the_keyboard_reaches_every_control(self):
        wanted = self.js("""[...document.querySelectorAll('a[href], button, select, input, summary, [tabindex="0"]')]
                            .filter(one =>
          one.checkVisibility() && !one.disabled && !(one.type === 'radio' && !one.checked)).length""")
        reached = set()
        for _ in range(wanted + 5):
            self.browser.send("Input.dispatchKeyEvent", type="keyDown", key="Tab", code="Tab", windowsVirtualKeyCode=9)
            reached.add(self.js("""(() => { const all = [...document.querySelectorAll('*')];
              return document.activeElement === document.body ? -1 : all.indexOf(document.activeElement); })()"""))
        self.assertGreaterEqual(len(reached - {-1}), wanted)

    def test_arrow_keys_walk_through_a_chart_and_what_they_find_is_said(self):
        self.js(f"document.querySelector({CHART!r}).focus()")
        self.browser.key("ArrowRight")
        self.browser.key("ArrowRight")
        self.browser.key("ArrowUp")
        said = self.texts(".explorer [role=status]")[0]
        self.assertRegex(said, r"^quadratic at number of segments N 20: 0\.25, 95 % interval 0\.2\d to 0\.2\d, 6 simulations$")
        self.browser.key("Escape")
        self.assertEqual(self.texts(".readout:not([hidden])"), [])

    def test_everything_that_can_be_used_or_read_has_a_name(self):
        self.browser.send("Accessibility.enable")
        nodes = self.browser.send("Accessibility.getFullAXTree")["nodes"]
        roles = {"button", "combobox", "slider", "radio", "application", "image", "region", "figure", "link", "group"}
        seen = [(one["role"]["value"], one.get("name", {}).get("value", "")) for one in nodes if not one.get("ignored")]
        self.assertEqual([role for role, name in seen if role in roles - {"figure", "group"} and not name.strip()], [])
        self.assertTrue({"button", "combobox", "slider", "radio", "application", "image"} <= {role for role, _ in seen})


class Films(Page):
    def pixels(self):
        return self.js("document.querySelector('.film canvas').toDataURL()")

    def test_they_play_pause_and_jump(self):
        still = self.pixels()
        self.browser.click(".film .play")
        self.js("new Promise(done => setTimeout(done, 300))")
        self.assertEqual(self.texts(".film .play")[0], "Pause")
        self.browser.click(".film .play")
        self.assertNotEqual(self.pixels(), still)
        self.js("(() => { const scrub = document.querySelector('.film input'); scrub.value = 0;"
                "scrub.dispatchEvent(new Event('input')); })()")
        self.assertEqual(self.texts(".film .clock")[0], "0.00 s")

    def test_the_view_turns_by_keys_and_by_dragging(self):
        front = self.pixels()
        self.js("document.querySelector('.film canvas').focus()")
        self.browser.key("ArrowRight")
        turned = self.pixels()
        self.assertNotEqual(turned, front)
        self.browser.key("ArrowLeft")
        self.assertEqual(self.pixels(), front)

    def test_they_begin_by_themselves_only_for_those_who_do_not_mind(self):
        for still in (True, False):
            self.browser.open(self.page, still=still)
            self.browser.box(".film canvas")
            self.js("new Promise(done => setTimeout(done, 200))")
            self.assertEqual(self.texts(".film .play")[0], "Play" if still else "Pause")


if __name__ == "__main__":
    if DRIVER is None:
        print("no browser: install the Debian packages python3-selenium and chromium-driver (make test-long)")
        sys.exit(77)
    unittest.main()
