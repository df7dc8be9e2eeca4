#include "runner/command/training_summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "runner/specs/training_job.hpp"
#include "runner/terminal/formats.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json to_json(const ValidationRatio::Ratios& ratios) {
  Json json = Json::array();
  for (const double ratio : ratios) json.push_back(or_null(ratio));
  return json;
}

std::string ending_text(const ModelCard& card) {
  const std::size_t done = card.epochs.size();
  switch (card.ending) {
    case Ending::none: return fmt::format("{} of {} epochs", done, card.planned_epochs);
    case Ending::complete: return fmt::format("all {} epochs", done);
    case Ending::early:
      return fmt::format("{} of {} epochs, the last {} without a better validation loss", done, card.planned_epochs,
                         done - static_cast<std::size_t>(card.best_epoch));
    case Ending::diverged:
      return fmt::format("ended after {} of {} epochs: {}", done, card.planned_epochs, card.message);
  }
  throw std::logic_error("an ending without a text");
}

std::string ratio_table(const ModelCard& card) {
  if (std::isnan(card.cg_ratio.front())) return "";
  std::string text =
      fmt::format("{:<41}", fmt::format("CG ratio on {} validation simulations", card.ratio_simulations));
  for (const double tolerance : ValidationRatio::tolerances()) text += fmt::format("{:>7.0e}", tolerance);
  const auto row = [&](const char* name, const ValidationRatio::Ratios& ratios) {
    text += fmt::format("\n  {:<39}", name);
    for (const double ratio : ratios) text += fmt::format("{:7.3f}", ratio);
  };
  row("the model", card.cg_ratio);
  row("its base guess alone", card.base_cg_ratio);
  for (const SceneRatios& of : card.scenes) {
    row(of.scene.c_str(), of.cg_ratio);
    row("  its base guess alone", of.base_cg_ratio);
  }
  return text + '\n';
}

/// The relative fall of the best validation loss in the second half of a complete training; 0 if it has too few epochs.
double late_fall(const ModelCard& card) {
  constexpr std::size_t fewest = 4;
  if (card.ending != Ending::complete || card.epochs.size() < fewest || card.best_epoch == 0) return 0;
  double halfway = HUGE_VAL;
  for (std::size_t i = 0; i < card.epochs.size() / 2; ++i) halfway = std::min(halfway, card.epochs[i].validation_loss);
  return std::max(0.0, 1 - best_epoch(card).validation_loss / halfway);
}

}  // namespace

std::string progress_text(const ModelCard& card, double seconds_left) {
  const std::vector<Epoch>& epochs = card.epochs;
  std::string text = fmt::format(
      "epoch {} of {}", std::min<std::int64_t>(static_cast<std::int64_t>(epochs.size()) + 1, card.planned_epochs),
      card.planned_epochs);
  if (!epochs.empty()) {
    const Epoch& last = epochs.back();
    text += fmt::format(", loss {:.4g}, validation {:.4g} (best {:.4g})", last.training_loss, last.validation_loss,
                        best_epoch(card).validation_loss);
    const auto measured = std::find_if(epochs.rbegin(), epochs.rend(),
                                       [](const Epoch& epoch) { return !std::isnan(epoch.cg_ratio.front()); });
    if (measured != epochs.rend()) text += fmt::format(", CG ratio {:.3f}", fmt::join(measured->cg_ratio, " "));
    text += fmt::format(", rate {:.1e}", last.rate);
  }
  return text + fmt::format(", {} left", duration_text(seconds_left));
}

std::string training_summary(const ModelCard& card, const std::filesystem::path& path) {
  std::string text = fmt::format("{}: {}", card.name, ending_text(card));
  if (card.best_epoch > 0)
    text += fmt::format("; the model is from epoch {}, validation loss {:.4g}", card.best_epoch,
                        best_epoch(card).validation_loss);
  text += '\n' + ratio_table(card);
  double seconds = 0;
  for (const Epoch& epoch : card.epochs) seconds += epoch.seconds;
  constexpr double notable = 0.1;
  if (const double fall = late_fall(card); fall > notable)
    text += fmt::format(
        "the validation loss fell by {:.0f} % in the second half of the epochs, so that more may lower it: {} take "
        "about {} (training.epochs, with another -o FILE)\n",
        100 * fall, count_text(2 * static_cast<std::int64_t>(card.epochs.size()), "epoch"), duration_text(2 * seconds));
  return text + fmt::format("{} for {} epochs; model: {}, {}", duration_text(seconds), card.epochs.size(),
                            path.native(), bytes_text(static_cast<std::int64_t>(std::filesystem::file_size(path))));
}

Json to_json(const RunRow& run) {
  const Provenance& p = run.provenance;
  return {{"begin", p.begin_utc},
          {"end", run.end_utc.empty() ? Json() : Json(run.end_utc)},
          {"exit_code", run.end_utc.empty() ? Json() : Json(run.exit_code)},
          {"host", p.host},
          {"ranks", p.ranks},
          {"command", p.user_command},
          {"revision", p.revision},
          {"versions", p.versions}};
}

Json to_json(const StoredModel& stored, const std::filesystem::path& path) {
  const ModelCard& card = stored.card;
  Json json{{"file", path.native()},
            {"kind", "model"},
            {"job", card.name},
            {"hash", model_hash(*stored.model)},
            {"network", network_json(stored.model->net.settings())},
            {"data", card.data_path},
            {"data_hash", card.data_hash},
            {"ended", card.ending != Ending::none},
            {"message", card.message},
            {"epochs", card.epochs.size()},
            {"planned_epochs", card.planned_epochs},
            {"best_epoch", card.best_epoch},
            {"validation_loss", card.best_epoch > 0 ? Json(best_epoch(card).validation_loss) : Json()},
            {"tolerances", ValidationRatio::tolerances()},
            {"cg_ratio", to_json(card.cg_ratio)},
            {"base_cg_ratio", to_json(card.base_cg_ratio)}};
  for (const SceneRatios& of : card.scenes)
    json["scenes"][of.scene] = {{"cg_ratio", to_json(of.cg_ratio)}, {"base_cg_ratio", to_json(of.base_cg_ratio)}};
  for (const RunRow& run : card.runs) json["runs"].push_back(to_json(run));
  return json;
}

std::string program_text(const Provenance& p) {
  return fmt::format("  command   {}\n  revision  {}\n  versions  {}\n", p.user_command, p.revision, p.versions);
}

std::string provenance_text(const StoredModel& stored) {
  const ModelCard& card = stored.card;
  std::string text =
      fmt::format("model    hash {}: {} parameters, {}\n", model_hash(*stored.model),
                  stored.model->net.parameters().values().size(), network_json(stored.model->net.settings()).dump());
  text += fmt::format("data     {}, hash {}: {} examples of {} simulations, {} of {} for validation\n", card.data_path,
                      card.data_hash, card.training_examples, card.training_simulations, card.validation_examples,
                      card.validation_simulations);
  for (std::size_t i = 0; i < card.runs.size(); ++i) {
    const Provenance& p = card.runs[i].provenance;
    text += fmt::format("run {}: {} to {} on {}, {}\n", i, p.begin_utc,
                        card.runs[i].end_utc.empty() ? "?" : card.runs[i].end_utc, p.host, count_text(p.ranks, "rank"));
    text += program_text(p);
  }
  text.pop_back();
  return text;
}

}  // namespace rodsweep
