#include "runner/command/training_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runner/terminal/text.hpp"

namespace rodsweep {
namespace {

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
  throw std::logic_error("an ending without words");
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
  return text + '\n';
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
    text += fmt::format("; the model is that of epoch {}, validation loss {:.4g}", card.best_epoch,
                        best_epoch(card).validation_loss);
  text += '\n' + ratio_table(card);
  double seconds = 0;
  for (const Epoch& epoch : card.epochs) seconds += epoch.seconds;
  return text + fmt::format("{} for {} epochs; model: {}, {}", duration_text(seconds), card.epochs.size(),
                            path.native(), bytes_text(static_cast<std::int64_t>(std::filesystem::file_size(path))));
}

}  // namespace rodsweep
