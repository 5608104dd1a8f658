#include "studies/paper/claims.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <set>

#include "engine/core/check.h"
#include "engine/core/files/csv_table.h"

namespace ed3r::paper {
namespace {

const std::vector<std::string> kColumns = {
    "id",     "where",      "strategy",  "metric",      "kind",         "paper_value", "unit",
    "source", "comparison", "tolerance", "exact_words", "inconsistent", "unmeasured",  "note"};
const std::set<std::string> kKinds = {"value", "share", "ratio", "order", "setup"};
const std::set<std::string> kSources = {"", "printed", "about", "derived", "construction"};

std::optional<double> Number(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

double HalfUnit(const std::string& printed) {
  const auto point = printed.find('.');
  const auto decimals = point == std::string::npos ? 0 : printed.size() - point - 1;
  return 0.5 * std::pow(10.0, -static_cast<double>(decimals));
}

bool Contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

// "share" rows are values too: the share of missions within ten minutes.
bool IsValueOfOneArm(const Claim& claim) {
  return (claim.kind == "value" || claim.kind == "share") && claim.comparison.empty();
}

int Rank(const Claim& claim, const PaperValue& value) {
  if (value.derived) return 2;
  return Contains(claim.where, "tab:") ? 0 : 1;
}

}  // namespace

std::vector<Claim> ParseClaims(std::string_view csv, std::string_view name) {
  const CsvTable table = CsvTable::Parse(std::string(name), std::string(csv));
  if (table.columns() != kColumns)
    throw UserError(fmt::format("{}:1: expected the columns {}", name, fmt::join(kColumns, ",")));
  std::vector<Claim> claims;
  std::set<std::string> ids;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    std::vector<std::string> row;
    for (std::size_t c = 0; c < kColumns.size(); ++c) row.push_back(table.Text(r, c));
    const auto refuse = [&](std::string_view column, const std::string& value, std::string_view allowed) {
      throw UserError(fmt::format("{}:{}: {}: '{}' is not {}", name, table.Line(r), column, value, allowed));
    };
    if (!ids.insert(row[0]).second) refuse("id", row[0], "a new id");
    if (kKinds.count(row[4]) == 0) refuse("kind", row[4], fmt::format("one of {}", fmt::join(kKinds, ", ")));
    if (kSources.count(row[7]) == 0)
      refuse("source", row[7], fmt::format("one of {}", fmt::join(kSources, ", ")));
    const auto tolerance = row[9].empty() ? std::optional(0.0) : Number(row[9]);
    if (!tolerance || !(*tolerance >= 0)) refuse("tolerance", row[9], "a number >= 0");
    claims.push_back({row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], *tolerance,
                      row[10], row[11], row[12], row[13]});
  }
  return claims;
}

std::optional<PaperValue> PaperValueOf(const Claim& claim) {
  const auto number = Number(claim.paper_value);
  if (!number) return std::nullopt;
  PaperValue value;
  value.value = *number;
  value.half_unit = HalfUnit(claim.paper_value);
  value.printed = claim.paper_value;
  value.claim = claim.id;
  value.approximate = claim.source == "about";
  value.derived = claim.source == "derived" || claim.source == "construction";
  return value;
}

const std::vector<Claim>& PaperClaims() {
  static const std::vector<Claim> claims = ParseClaims(ClaimsCsv(), "studies/paper/claims.csv");
  return claims;
}

std::optional<PaperValue> FindPaperValue(const std::vector<Claim>& claims, std::string_view arm,
                                         std::string_view metric) {
  std::vector<PaperValue> found;
  std::optional<PaperValue> best;
  int best_rank = 0;
  for (const Claim& claim : claims) {
    if (claim.strategy != arm || claim.metric != metric || !IsValueOfOneArm(claim)) continue;
    const auto value = PaperValueOf(claim);
    if (!value) continue;
    found.push_back(*value);
    const int rank = Rank(claim, *value);
    if (!best || rank < best_rank) best = value, best_rank = rank;
  }
  if (!best) return std::nullopt;
  for (const PaperValue& other : found)
    if (other.value != best->value)
      best->elsewhere.push_back(fmt::format("{} ({})", other.printed, other.claim));
  return best;
}

}  // namespace ed3r::paper
