#include "studies/claims/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "engine/core/check.h"
#include "studies/metrics/definitions.h"

namespace ed3r::claims {
namespace {

using Kind = Quantity::Kind;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

void Collect(const Quantity& quantity, std::set<Cell>& cells) {
  if (quantity.kind == Kind::kCell) cells.insert(quantity.cell);
  for (const Quantity& part : quantity.of) Collect(part, cells);
}

void Collect(const Formula& formula, std::vector<const Formula*>& leaves) {
  if (formula.kind == Formula::Kind::kLess || formula.kind == Formula::Kind::kSimilar)
    leaves.push_back(&formula);
  for (const Formula& part : formula.of) Collect(part, leaves);
}

double Extreme(const Quantity& quantity, const CellValue& value, bool largest) {
  double extreme = kNone;
  for (const Quantity& part : quantity.of) {
    const double x = ValueOf(part, value);
    if (std::isnan(x)) return kNone;
    if (std::isnan(extreme) || (largest ? x > extreme : x < extreme)) extreme = x;
  }
  return extreme;
}

double Mean(const Quantity& quantity, const CellValue& value) {
  double sum = 0;
  for (const Quantity& part : quantity.of) sum += ValueOf(part, value);
  return sum / static_cast<double>(quantity.of.size());
}

std::string_view SymbolOf(Kind kind) {
  switch (kind) {
    case Kind::kAdd:
      return " + ";
    case Kind::kSubtract:
      return " - ";
    case Kind::kMultiply:
      return "*";
    case Kind::kDivide:
      return " / ";
    case Kind::kMax:
      return "max";
    case Kind::kMin:
      return "min";
    default:
      return "mean";
  }
}

std::string Render(const Quantity& quantity, bool with_metrics, bool inside) {
  const auto part = [&](std::size_t i) { return Render(quantity.of[i], with_metrics, true); };
  switch (quantity.kind) {
    case Kind::kNumber:
      return fmt::format("{}", quantity.number);
    case Kind::kCell:
      return with_metrics ? fmt::format("{}({})", metrics::MetricDefinitions()[quantity.cell.metric].name,
                                        quantity.cell.arm)
                          : quantity.cell.arm;
    case Kind::kAdd:
    case Kind::kSubtract: {
      const std::string text = part(0) + std::string(SymbolOf(quantity.kind)) + part(1);
      return inside ? '(' + text + ')' : text;
    }
    case Kind::kMultiply:
    case Kind::kDivide:
      return part(0) + std::string(SymbolOf(quantity.kind)) + part(1);
    default:
      break;
  }
  std::string text = std::string(SymbolOf(quantity.kind)) + '(';
  for (std::size_t i = 0; i < quantity.of.size(); ++i)
    text += (i > 0 ? ", " : "") + Render(quantity.of[i], with_metrics, false);
  return text + ')';
}

bool HasSeveralMetrics(const std::set<Cell>& cells) {
  return std::any_of(cells.begin(), cells.end(),
                     [&](const Cell& c) { return c.metric != cells.begin()->metric; });
}

std::string Canonical(const Formula& formula);

// "all" within "all" is one "all".
void CollectParts(const Formula& formula, Formula::Kind kind, std::set<std::string>& parts) {
  for (const Formula& part : formula.of) {
    if (part.kind == kind || part.of.size() == 1)
      CollectParts(part, kind, parts);
    else
      parts.insert(Canonical(part));
  }
}

std::string Canonical(const Formula& formula) {
  if (formula.of.empty()) {
    std::string left = Render(formula.left, true, false), right = Render(formula.right, true, false);
    if (formula.kind == Formula::Kind::kLess) return fmt::format("{} < {}", left, right);
    if (right < left) std::swap(left, right);
    return fmt::format("{} ~ {}", left, right);
  }
  std::set<std::string> parts;
  CollectParts(formula, formula.kind, parts);
  if (parts.size() == 1) return *parts.begin();
  return fmt::format("{}({})", formula.kind == Formula::Kind::kAll ? "all" : "any", fmt::join(parts, "; "));
}

}  // namespace

std::string CanonicalText(const Expression& expression) {
  return expression.is_quantity ? Render(expression.quantity, true, false) : Canonical(expression.formula);
}

double ValueOf(const Quantity& quantity, const CellValue& value) {
  switch (quantity.kind) {
    case Kind::kNumber:
      return quantity.number;
    case Kind::kCell:
      return value(quantity.cell);
    case Kind::kAdd:
      return ValueOf(quantity.of[0], value) + ValueOf(quantity.of[1], value);
    case Kind::kSubtract:
      return ValueOf(quantity.of[0], value) - ValueOf(quantity.of[1], value);
    case Kind::kMultiply:
      return ValueOf(quantity.of[0], value) * ValueOf(quantity.of[1], value);
    case Kind::kDivide:
      return ValueOf(quantity.of[0], value) / ValueOf(quantity.of[1], value);
    case Kind::kMax:
      return Extreme(quantity, value, true);
    case Kind::kMin:
      return Extreme(quantity, value, false);
    case Kind::kMean:
      return Mean(quantity, value);
  }
  return kNone;
}

bool Holds(const Formula& formula, double tolerance, const CellValue& value) {
  const auto holds = [&](const Formula& part) { return Holds(part, tolerance, value); };
  switch (formula.kind) {
    case Formula::Kind::kAll:
      return std::all_of(formula.of.begin(), formula.of.end(), holds);
    case Formula::Kind::kAny:
      return std::any_of(formula.of.begin(), formula.of.end(), holds);
    case Formula::Kind::kLess:
      return ValueOf(formula.left, value) < ValueOf(formula.right, value);
    case Formula::Kind::kSimilar:
      return std::abs(ValueOf(formula.left, value) - ValueOf(formula.right, value)) < tolerance;
  }
  return false;
}

std::vector<const Formula*> LeavesOf(const Formula& formula) {
  std::vector<const Formula*> leaves;
  Collect(formula, leaves);
  return leaves;
}

std::vector<Cell> CellsOf(const Expression& expression) {
  std::set<Cell> cells;
  if (expression.is_quantity) Collect(expression.quantity, cells);
  for (const Formula* leaf : LeavesOf(expression.formula))
    Collect(leaf->left, cells), Collect(leaf->right, cells);
  return {cells.begin(), cells.end()};
}

std::vector<Cell> CellsOf(const Quantity& quantity) {
  Expression whole;
  whole.is_quantity = true;
  whole.quantity = quantity;
  return CellsOf(whole);
}

std::string TextOf(const Quantity& quantity) {
  std::set<Cell> cells;
  Collect(quantity, cells);
  return Render(quantity, HasSeveralMetrics(cells), false);
}

std::string TextOf(const Formula& leaf) {
  std::set<Cell> cells;
  Collect(leaf.left, cells), Collect(leaf.right, cells);
  const bool several = HasSeveralMetrics(cells);
  return Render(leaf.left, several, false) + (leaf.kind == Formula::Kind::kLess ? " < " : " ~ ") +
         Render(leaf.right, several, false);
}

}  // namespace ed3r::claims
