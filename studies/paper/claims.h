// What the paper prints: every number and statement of its evaluation, as data (claims.csv, compiled in).
//
// Threads: all functions may be called from any thread; the list is read once and never changes.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::paper {

// One row of claims.csv. `kind`:
//   value   a number of one arm
//   share   the same, a share of missions or of energy
//   ratio   a number that compares arms
//   order   which arm has more; no number
//   setup   how the study was made
struct Claim {
  std::string id;           // "C104"
  std::string where;        // "Res3 tab:baseline_comparisons"
  std::string strategy;     // the arms that it speaks of ("ed3r-75", "rbs-p85"), separated by spaces
  std::string metric;       // a metric's name
  std::string kind;         // see above
  std::string paper_value;  // as printed; empty for an order
  std::string unit;
  std::string source;  // of the value: printed, about, derived, construction; empty without one
  std::string
      comparison;  // what is claimed, in the notation of studies/claims/expression.h; empty: the arm's metric
  double tolerance = 0;      // beyond the value's rounding, in `unit`: how the words' vagueness was read
  std::string exact_words;   // the paper's, without markup
  std::string inconsistent;  // the arithmetic by which the paper contradicts itself here; mostly empty
  std::string unmeasured;    // why no run can show it; mostly empty
  std::string note;
};

// Rows of `csv` in order. Throws UserError "name:line: ..." for a table with other columns, kinds or
// sources, a repeated id, a tolerance that is no number.
std::vector<Claim> ParseClaims(std::string_view csv, std::string_view name);

// The paper's claims.
const std::vector<Claim>& PaperClaims();

// A number that the paper gives for one metric of one arm.
struct PaperValue {
  double value = 0;
  double half_unit = 0;      // half of the last printed digit: what rounding may hide
  std::string printed;       // "21.44"
  std::string claim;         // "C104"
  bool approximate = false;  // printed as "about"
  bool derived = false;      // follows from what is printed (100 - MSR - FP), or from how the arm is built
  std::vector<std::string>
      elsewhere;  // other values that the paper prints for the same thing: "21.33 (C012)"
};

// The number of a claim; none for an order, and for "n/a".
std::optional<PaperValue> PaperValueOf(const Claim& claim);

// What the paper gives for `metric` of `arm` ("ed3r-75", "ed3r-p85", ...), or nothing. Where it prints
// several values, its table goes before its text, its text before what is derived, and the first before the
// later ones; those that differ are listed in `elsewhere`.
std::optional<PaperValue> FindPaperValue(const std::vector<Claim>& claims, std::string_view arm,
                                         std::string_view metric);

// The text of claims.csv.
std::string_view ClaimsCsv();

}  // namespace ed3r::paper
