#include "runner/command/model_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "runner/command/training_summary.hpp"
#include "runner/job/training_job.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json to_json(const ValidationRatio::Ratios& ratios) {
  Json json = Json::array();
  for (const double ratio : ratios) json.push_back(or_null(ratio));
  return json;
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
  for (const TrainingStart& start : card.starts)
    json["starts"].push_back({{"begin", start.provenance.begin_utc},
                              {"end", start.end_utc.empty() ? Json() : Json(start.end_utc)},
                              {"exit_code", start.end_utc.empty() ? Json() : Json(start.exit_code)},
                              {"host", start.provenance.host},
                              {"ranks", start.provenance.ranks},
                              {"command", start.provenance.user_command},
                              {"revision", start.provenance.revision},
                              {"versions", start.provenance.versions}});
  return json;
}

std::string provenance_text(const StoredModel& stored) {
  const ModelCard& card = stored.card;
  std::string text =
      fmt::format("model    hash {}: {} parameters, {}\n", model_hash(*stored.model),
                  stored.model->net.parameters().values().size(), network_json(stored.model->net.settings()).dump());
  text += fmt::format("data     {}, hash {}: {} examples of {} simulations, {} of {} for validation\n", card.data_path,
                      card.data_hash, card.training_examples, card.training_simulations, card.validation_examples,
                      card.validation_simulations);
  for (std::size_t i = 0; i < card.starts.size(); ++i) {
    const Provenance& p = card.starts[i].provenance;
    text += fmt::format("start {}: {} to {} on {}, {} rank{}\n  command   {}\n  revision  {}\n  versions  {}\n", i,
                        p.begin_utc, card.starts[i].end_utc.empty() ? "?" : card.starts[i].end_utc, p.host, p.ranks,
                        p.ranks == 1 ? "" : "s", p.user_command, p.revision, p.versions);
  }
  text.pop_back();
  return text;
}

}  // namespace

ExitCode show_model_status(const StatusOptions& options, Console& console) {
  const StoredModel stored = read_training(options.file);
  console.result(options.json ? to_json(stored, options.file).dump(2) : training_summary(stored.card, options.file));
  return ExitCode::ok;
}

ExitCode show_model_info(const InfoOptions& options, Console& console) {
  const StoredModel stored = read_training(options.file);
  if (options.job) {
    console.raw_result(stored.card.job_text);
  } else if (options.json) {
    console.result(to_json(stored, options.file).dump(2));
  } else {
    console.result(training_summary(stored.card, options.file) + '\n' + provenance_text(stored));
    if (options.verify) console.result("verified: the model is as it was written");  // else it could not be read
  }
  return ExitCode::ok;
}

}  // namespace rodsweep
