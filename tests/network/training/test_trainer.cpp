// Training reduces the loss, and its bits depend on its settings only; Adam against its definition.
#include <cmath>

#include "network/training/adam.hpp"
#include "network/training/threads.hpp"
#include "network/training/trainer.hpp"
#include "tests/catch.hpp"
#include "tests/network/models.hpp"
#include "tests/network/stored.hpp"

namespace rodsweep::test_trainer {

using namespace test;

TrainingSettings small_training() {
  TrainingSettings settings;
  settings.epochs = 4;
  settings.batch = 8;
  settings.shards = 4;
  settings.seed = 5;
  return settings;
}

CopingNetSettings small_network(Processor processor = Processor::factors) {
  CopingNetSettings settings;
  settings.processor = processor;
  settings.base = BaseGuess::none;
  settings.latent = 8;
  settings.steps = 2;
  return settings;
}

/// One step; returns its loss. Computes the shards as `ranks` ranks would, each its own at once, the last rank first.
double step(Trainer& trainer, int shards, int ranks = 1) {
  std::vector<std::vector<float>> contributions(static_cast<std::size_t>(shards));
  std::vector<const float*> in_order;
  for (auto& contribution : contributions) {
    contribution.resize(trainer.shard_size());
    in_order.push_back(contribution.data());
  }
  for (int rank = ranks - 1; rank >= 0; --rank) {
    std::vector<Trainer::Shard> own;
    for (int shard = rank; shard < shards; shard += ranks) own.push_back({shard, contributions[shard].data()});
    trainer.compute(own);
  }
  return trainer.update(in_order);
}

double mean_loss(Trainer& trainer, const std::vector<Example>& examples) {
  double sum = 0;
  for (const double part : trainer.losses(examples, [](int) { return true; })) sum += part;
  return sum / static_cast<double>(examples.size());
}

TEST_CASE("a few examples are learned by heart, with every processor and loss, moves of segments too") {
  struct Case {
    CopingNetSettings network;
    LossKind loss;
    double left;  ///< of the loss
  };
  const CopingNetSettings factors = small_network(), messages = small_network(Processor::message_passing);
  CopingNetSettings moving = messages;
  moving.encoding = Encoding::paper_residual;
  moving.moves = true;
  const CopingNetSettings states = message_passing(Encoding::state, true);
  for (const Case& of : {Case{factors, LossKind::energy, 0.15}, Case{factors, LossKind::mse, 0.05},
                         Case{messages, LossKind::energy, 0.15}, Case{messages, LossKind::mse, 0.05},
                         Case{messages, LossKind::in_the_loop, 0.5}, Case{moving, LossKind::mse, 0.05},
                         Case{states, LossKind::mse, 0.05}}) {
    CAPTURE(static_cast<int>(of.network.processor), static_cast<int>(of.loss), of.network.moves);
    const Examples data = sample_examples(of.network, 1, of.network.encoding == Encoding::state ? 9 : 4);
    TrainingSettings settings = small_training();
    settings.loss = of.loss;
    settings.epochs = 300;
    settings.shards = 1;
    settings.rate = 0.02;
    CopingNet<float> net(of.network, 1);
    Trainer trainer(net, data.examples, settings);
    REQUIRE(data.examples.size() == 8);
    const double before = mean_loss(trainer, data.examples);
    while (trainer.step() < trainer.steps()) step(trainer, 1);
    CHECK(mean_loss(trainer, data.examples) < of.left * before);
  }
}

TEST_CASE("a network learns from the features that a guess gives it, though no example keeps them") {
  for (const Processor processor : {Processor::factors, Processor::message_passing}) {
    const CopingNetSettings settings = small_network(processor);
    const StoredSimulation simulation = stored_simulation(sample_scene(3), 2);
    std::vector<Example> examples;
    add_examples(settings, simulation, examples);
    REQUIRE(examples.size() > 2);
    CHECK(examples.front().edges.size() == 0);
    const Batch<float> batch = make_batch<float>({&examples[0], &examples[1]});
    Replay replay(simulation);
    Eigen::Index first = 0;
    replay.run([&](const StoredSystem& stored, const Rod& rod, const LinearSystem& system) {
      if (first == batch.edges.cols()) return;
      FeatureEncoder encoder(settings, rod, system.matrix());
      Tensor<float> nodes(0, rod.segment_count()), edges(edge_features(settings), rod.joint_count());
      const VectorX zero = VectorX::Zero(system.rhs().size());
      encoder.encode(rod, system, stored.at.newton, zero, system.rhs(), nodes, edges);
      CHECK((batch.edges.middleCols(first, edges.cols()) - edges).cwiseAbs().maxCoeff() < 1e-6F);
      first += edges.cols();
    });
    CHECK(first == batch.edges.cols());
  }
}

TEST_CASE("weights and losses have the same bits however the shards are divided among ranks and threads") {
  for (const Processor processor : {Processor::factors, Processor::message_passing}) {
    const Examples data = sample_examples(small_network(processor), 3, 4);
    AlignedVector<float> first;
    std::vector<double> losses;
    for (const auto& [ranks, threads] : {std::pair(1, 1), {2, 1}, {3, 1}, {4, 1}, {9, 1}, {1, 2}, {1, 3}, {1, 6}}) {
      CAPTURE(static_cast<int>(processor), ranks, threads);
      CopingNet<float> net(small_network(processor), 1);
      Trainer trainer(net, data.examples, small_training(), threads);
      while (trainer.step() < trainer.steps()) step(trainer, 4, ranks);
      const std::vector<double> judged = trainer.losses(data.examples, [](int batch) { return batch != 1; });
      if (first.empty()) first = net.parameters().values();
      if (losses.empty()) losses = judged;
      CHECK(net.parameters().values() == first);
      CHECK(judged == losses);
      CHECK(judged.at(1) == 0);
    }
  }
}

TEST_CASE("work on threads is done once each, and what it throws arrives") {
  std::vector<int> done(50);
  const auto work = [&](int item, int thread) {
    if (thread < 0 || thread > 3) throw std::logic_error("no such thread");
    ++done[item];
    if (item == 7) throw std::runtime_error("seven");
  };
  CHECK_THROWS_WITH(in_parallel(50, 4, work), "seven");
  CHECK(done == std::vector<int>(50, 1));
  in_parallel(0, 4, work);
}

TEST_CASE("every example is seen once in an epoch, in another order in the next and with another seed") {
  const CopingNetSettings network = small_network();
  std::vector<Example> examples = sample_examples(network, 3, 4).examples;
  TrainingSettings settings = small_training();
  settings.batch = settings.shards = 1;
  settings.rate = 1e-30;  // weights stay constant, so that a loss identifies its example
  const auto losses = [&](std::uint64_t seed) {
    settings.seed = seed;
    CopingNet<float> net(network, 1);
    Trainer trainer(net, examples, settings);
    std::vector<std::vector<double>> by_epoch(2);
    for (auto& epoch : by_epoch)
      for (std::size_t i = 0; i < examples.size(); ++i) epoch.push_back(step(trainer, 1));
    return by_epoch;
  };
  const auto epochs = losses(5);
  CHECK(epochs[0] != epochs[1]);
  CHECK(losses(6)[0] != epochs[0]);
  CHECK(losses(5) == epochs);
  const auto sorted = [](std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values;
  };
  CHECK(sorted(epochs[0]) == sorted(epochs[1]));
}

TEST_CASE("the rate rises to its peak and falls to zero") {
  const Examples data = sample_examples(small_network(), 3, 4);
  TrainingSettings settings = small_training();
  settings.epochs = 20;
  settings.warm_up = 0.25;
  CopingNet<float> net(small_network(), 1);
  Trainer trainer(net, data.examples, settings);
  std::vector<double> rates;
  while (trainer.step() < trainer.steps()) {
    step(trainer, 4);
    rates.push_back(trainer.rate());
  }
  const std::size_t peak = rates.size() / 4 - 1;
  CHECK(rates[0] == Approx(settings.rate / (static_cast<double>(peak) + 1)));
  CHECK(rates[peak] == Approx(settings.rate));
  CHECK(std::is_sorted(rates.begin(), rates.begin() + static_cast<std::ptrdiff_t>(peak) + 1));
  CHECK(std::is_sorted(rates.rbegin(), rates.rend() - static_cast<std::ptrdiff_t>(peak)));
  CHECK(rates.back() == Approx(0).margin(1e-12));
}

TEST_CASE("a gradient far longer than usual moves the weights as one of three times the usual norm") {
  const Examples data = sample_examples(small_network(), 3, 4);
  TrainingSettings settings = small_training();
  settings.epochs = 200;
  settings.clip = 1e9;
  // The same contribution from each shard; alternating signs leave Adam's mean near zero.
  const auto trained = [&](float last) {
    CopingNet<float> net(small_network(), 1);
    Trainer trainer(net, data.examples, settings);
    std::vector<float> shard(trainer.shard_size());
    const auto update = [&](float gradient) {
      std::fill(shard.begin(), shard.end(), gradient);
      trainer.update(std::vector<const float*>(4, shard.data()));
    };
    for (int k = 0; k < 120; ++k) update(k % 2 == 0 ? 1.F : -1.F);
    update(last);
    return net.parameters().values();
  };
  const auto spike = trained(1e4F), three = trained(3.F), two = trained(2.F);
  double largest = 0, other = 0;
  for (std::size_t i = 0; i < spike.size(); ++i) {
    largest = std::max(largest, static_cast<double>(std::abs(spike[i] - three[i])));
    other = std::max(other, static_cast<double>(std::abs(two[i] - three[i])));
  }
  CHECK(largest < 1e-6);
  CHECK(other > 1e-5);
}

TEST_CASE("settings that make no sense are refused") {
  const Examples data = sample_examples(small_network(), 1, 4);
  CopingNet<float> net(small_network(), 1);
  TrainingSettings settings = small_training();
  settings.shards = 3;
  CHECK_THROWS_WITH(Trainer(net, data.examples, settings),
                    Catch::Matchers::ContainsSubstring("8") && Catch::Matchers::ContainsSubstring("3 equal shards"));
  settings.shards = 4;
  settings.batch = 12;
  CHECK_THROWS_WITH(Trainer(net, data.examples, settings), Catch::Matchers::ContainsSubstring("8 examples") &&
                                                               Catch::Matchers::ContainsSubstring("batch of 12"));
}

TEST_CASE("two steps follow the definition") {
  AlignedVector<float> weights{0.5F};
  Adam adam(1, {0.8, 0.9, 1e-8, 0.01});
  double m = 0, v = 0, w = 0.5;
  for (int t = 1; t <= 2; ++t) {
    const double g = t == 1 ? 0.3 : -0.7;
    m = 0.8 * m + 0.2 * g;
    v = 0.9 * v + 0.1 * g * g;
    w -= 0.05 * (m / (1 - std::pow(0.8, t)) / (std::sqrt(v / (1 - std::pow(0.9, t))) + 1e-8) + 0.01 * w);
    adam.step(0.05, {static_cast<float>(g)}, weights);
  }
  CHECK(weights[0] == Approx(w).epsilon(1e-6));
}

}  // namespace rodsweep::test_trainer
