#include "engine/app/status_watch.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <thread>

#include "engine/app/commands.h"
#include "engine/app/words.h"
#include "engine/core/files/file.h"
#include "engine/core/interrupt.h"
#include "engine/store/schema.h"
#include "engine/store/shards/gathered_shards.h"
#include "engine/store/tally.h"
#include "studies/metrics/metrics.h"
#include "studies/report/load.h"
#include "studies/report/page_parts.h"

namespace ed3r::app {
namespace {

constexpr auto kNap = std::chrono::milliseconds(100);  // how late Ctrl-C may be seen
constexpr double kMinute_s = 60, kHour_s = 3600;

std::string PlusMinus(const metrics::MetricValue& value, int decimals, const char* unit) {
  if (std::isnan(value.lo)) return "";
  return fmt::format("{:.{}f} ± {:.{}f} {}", value.value, decimals, 0.5 * (value.hi - value.lo), decimals,
                     unit);
}

std::string KnownText(const StatusLook& look, const store::ArmStatus& arm) {
  for (const StatusLook::Known& known : look.known)
    if (known.stage == arm.stage && known.arm == arm.arm && !known.success.empty())
      return known.success + ", " + known.energy;
  return "";
}

std::string Summary(const StatusLook& look) {
  const std::int64_t planned = look.Done() + look.Missing();
  std::string text = fmt::format("{} of {} missions", look.Done(), planned);
  if (look.Missing() == 0) return text + ", nothing missing";
  if (look.PerMinute() > 0) text += fmt::format(", {:.0f} a minute", look.PerMinute());
  const std::string left = look.Left();
  return left.empty() ? text : text + ", " + left + " left";
}

// To the beginning of what was shown before, so that it is replaced.
void Show(const std::string& text, bool first) {
  if (isatty(STDOUT_FILENO) && !first) fmt::print("\x1b[H\x1b[J");
  if (isatty(STDOUT_FILENO) && first) fmt::print("\x1b[2J\x1b[H");
  fmt::print("{}", text);
  std::fflush(stdout);
}

// Ctrl-C is how a look ends; a batch system asks why.
int ToldInterruption() {
  if (!AsksRequeue(InterruptSignal())) return kInterrupted;
  Tell("ended by {}", SignalName(InterruptSignal()));
  return kRequeue;
}

bool Sleep(int seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  while (std::chrono::steady_clock::now() < end) {
    if (InterruptFlag()) return false;
    std::this_thread::sleep_for(kNap);
  }
  return !InterruptFlag();
}

}  // namespace

std::int64_t StatusLook::Done() const {
  std::int64_t done = 0;
  for (const store::ArmStatus& arm : arms) done += arm.done + arm.failed;
  return done;
}

std::int64_t StatusLook::Missing() const {
  std::int64_t missing = 0;
  for (const store::ArmStatus& arm : arms) missing += arm.missing;
  return missing;
}

double StatusLook::PerMinute() const {
  return seconds > 0 ? kMinute_s * static_cast<double>(Done() - done_at_first) / seconds : 0;
}

std::string StatusLook::Left() const {
  if (!(PerMinute() > 0) || Missing() == 0) return "";
  const double left_s = kMinute_s * static_cast<double>(Missing()) / PerMinute();
  if (left_s < kMinute_s) return "less than a minute";
  return left_s < 2 * kHour_s ? fmt::format("about {:.0f} min", left_s / kMinute_s)
                              : fmt::format("about {:.1f} h", left_s / kHour_s);
}

namespace {

// Counted where they are: joining the shards for intervals would take longer than a look may.
StatusLook LookAtShards(const std::vector<std::string>& stores) {
  StatusLook look;
  const store::ResultReader first(stores.front());
  look.name = first.Layout().name;
  store::Tally tally(first.StoredRecipe(), first.Layout());
  for (const std::string& store : stores) tally.Add(store);
  look.arms = tally.Arms();
  return look;
}

}  // namespace

StatusLook LookAt(const std::string& dir) {
  const std::vector<std::string> stores = store::StoresThatAdd(dir).dirs;
  if (stores.size() > 1 || (stores.size() == 1 && stores.front() != dir)) return LookAtShards(stores);
  StatusLook look;
  store::ResultReader reader(dir);
  const store::Transaction moment = reader.Moment();  // counts and intervals are of one
  look.name = reader.Layout().name;
  look.arms = reader.Status();
  for (const metrics::ArmData& arm : report::LoadRun(reader).arms) {
    for (store::ArmStatus& status : look.arms)
      if (status.stage == arm.stage && status.arm == arm.name)
        status.missing = arm.missing;  // none where a precision has been reached
    if (arm.missions.empty()) continue;
    const metrics::ArmMetrics metrics = metrics::ComputeMetrics(arm);
    look.known.push_back({arm.stage, arm.name, PlusMinus(metrics["msr_pct"], 1, "%"),
                          PlusMinus(metrics["total_energy_kj"], 2, "kJ")});
  }
  return look;
}

std::string StatusText(const StatusLook& look) {
  std::string text =
      fmt::format("{}: {}\n\n{:<12} {:<24} {:>8} {:>8} {:>8} {:>8}  {}\n", look.name, Summary(look), "stage",
                  "arm", "planned", "done", "failed", "missing", "success, energy with 95 %");
  for (const store::ArmStatus& arm : look.arms)
    text += fmt::format("{:<12} {:<24} {:>8} {:>8} {:>8} {:>8}  {}\n", arm.stage, arm.arm, arm.planned,
                        arm.done, arm.failed, arm.missing, KnownText(look, arm));
  return text;
}

std::string StatusPage(const StatusLook& look, int seconds) {
  const bool ended = look.Missing() == 0;
  const double share = static_cast<double>(look.Done()) /
                       static_cast<double>(std::max<std::int64_t>(1, look.Done() + look.Missing()));
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">{}<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><title>{:.0f} % – {}</title>\n<style>"
      ":root{{color-scheme:light dark}}body{{font:16px/1.5 system-ui,\"DejaVu "
      "Sans\",sans-serif;margin:1.5rem "
      "auto;max-width:70rem;padding:0 1rem}}table{{border-collapse:collapse;width:100%}}"
      "th,td{{text-align:right;padding:.25rem .6rem;border-bottom:1px solid GrayText}}"
      "th:first-child,th:nth-child(2),td:first-child,td:nth-child(2){{text-align:left}}"
      "progress{{width:100%;height:1.2rem}}div{{overflow-x:auto}}</style></head>\n<body><main><h1>{}</h1>\n"
      "<p>{}{}</p>\n<progress max=\"1\" value=\"{:.4f}\" aria-label=\"missions "
      "done\"></progress>\n<div><table>\n"
      "<tr><th>stage</th><th>arm</th><th>planned</th><th>done</th><th>failed</th><th>missing</th>"
      "<th>success, energy with 95 %</th></tr>\n",
      ended ? "" : fmt::format("<meta http-equiv=\"refresh\" content=\"{}\">", seconds), 100 * share,
      report::HtmlText(look.name), report::HtmlText(look.name), Summary(look),
      ended ? "."
            : fmt::format("; as of {:%Y-%m-%d %H:%M:%S} UTC, this page shows itself anew every {} s.",
                          fmt::gmtime(std::time(nullptr)), seconds),
      share);
  for (const store::ArmStatus& arm : look.arms)
    page += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        report::HtmlText(arm.stage), report::HtmlText(arm.arm), arm.planned, arm.done, arm.failed,
        arm.missing, KnownText(look, arm));
  return page + "</table></div></main></body></html>\n";
}

int WatchStatus(const WatchOptions& options) {
  if (!options.html.empty()) {
    std::vector<std::string> stores = store::StoresThatAdd(options.dir).dirs;
    for (std::string& store : stores) store = (std::filesystem::path(store) / store::kResultsFile).string();
    CheckNoInput(options.html, stores, "--html");
  }
  InstallInterruptHandler();
  const auto begin = std::chrono::steady_clock::now();
  std::int64_t done_at_first = -1;
  while (true) {
    StatusLook look = LookAt(options.dir);
    const bool first = done_at_first < 0;
    if (first) done_at_first = look.Done();
    look.done_at_first = done_at_first;
    look.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (options.terminal) Show(StatusText(look), first);
    if (!options.html.empty()) WriteFile(options.html, StatusPage(look, options.seconds));
    if (look.Missing() == 0) return kDone;
    if (!Sleep(options.seconds)) return ToldInterruption();
  }
}

}  // namespace ed3r::app
