// What a claim says, as data, and the notation that claims.csv writes it in.
//
//   claim    := part (";" part)*                      all parts must hold; or one quantity, for a number
//   part     := list (("<" | ">") list)+              all quantities of one list against all of the next
//             | list "~" list                         they differ by less than the claim's tolerance
//             | "frontier" "(" list ")"               no arm of the study dominates any of them
//             | "dominated" "(" list ")" "by" list    each of the first is dominated by one of the second
//   list     := sum ("," sum)*
//   sum      := product (("+" | "-") product)*
//   product  := atom (("*" | "/") atom)*
//   atom     := NUMBER | arm | METRIC "(" arm ")" | ("max" | "min" | "mean") "(" list ")" | "(" sum ")"
//   arm      := NAME                                  one of StudyArms(), of the claim's metric
//             | NAME ".." DIGIT                       in a list: "ablation-1..4" is all four
//
// "a dominates b": lower mean energy and higher success rate (Fig. pareto). Arms are names, metrics those of
// studies/metrics/definitions.h. Pure functions, any thread.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ed3r::claims {

// One metric of one arm.
struct Cell {
  std::string arm;
  std::size_t metric = 0;  // in MetricDefinitions()
  auto operator<=>(const Cell&) const = default;
};

// A number made from cells.
struct Quantity {
  enum class Kind { kNumber, kCell, kAdd, kSubtract, kMultiply, kDivide, kMax, kMin, kMean };
  Kind kind = Kind::kNumber;
  double number = 0;         // kNumber
  Cell cell;                 // kCell
  std::vector<Quantity> of;  // two for the arithmetic, one or more for kMax, kMin, kMean
};

// A statement about quantities: kLess is left < right, kSimilar |left - right| < tolerance.
struct Formula {
  enum class Kind { kLess, kSimilar, kAll, kAny };
  Kind kind = Kind::kAll;
  Quantity left, right;     // kLess, kSimilar
  std::vector<Formula> of;  // kAll, kAny
};

// Exactly one of the two is there.
struct Expression {
  bool is_quantity = false;
  Quantity quantity;
  Formula formula;
};

// The paper's nine online arms, and their P85 groups behind them (names as P85Name gives them).
const std::vector<std::string>& StudyArms();

// `metric` is the one that bare arms stand for; it may be a word that is no metric ("pareto") where there are
// none.
// Throws UserError "text:COLUMN: ..." with what is wrong, what is allowed and the nearest known name.
Expression ParseExpression(std::string_view text, std::string_view metric);

using CellValue = std::function<double(const Cell&)>;

// NaN where a cell is; division by zero gives what IEEE says.
double ValueOf(const Quantity& quantity, const CellValue& value);

// Whether the formula holds for these values; comparisons with NaN do not hold.
bool Holds(const Formula& formula, double tolerance, const CellValue& value);

// Cells of the expression, each once, sorted.
std::vector<Cell> CellsOf(const Expression& expression);
std::vector<Cell> CellsOf(const Quantity& quantity);

// kLess and kSimilar formulas in it, from left to right.
std::vector<const Formula*> LeavesOf(const Formula& formula);

// The same for expressions that say the same: "a > b" and "b < a", parts in any order, metrics named or not.
std::string CanonicalText(const Expression& expression);

// In the notation above, metrics left out where all are the same.
std::string TextOf(const Quantity& quantity);
std::string TextOf(const Formula& leaf);

}  // namespace ed3r::claims
