// The parser of claim expressions: recursive descent over the grammar of expression.h.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "engine/core/check.h"
#include "engine/core/suggest.h"
#include "studies/claims/expression.h"
#include "studies/metrics/arm.h"
#include "studies/metrics/definitions.h"
#include "studies/paper/arms.h"

namespace ed3r::claims {
namespace {

using Kind = Quantity::Kind;
using List = std::vector<Quantity>;

const std::vector<std::string>& OnlineArms() {
  static const std::vector<std::string> arms = [] {
    std::vector<std::string> names;
    for (const paper::PaperArm& arm : paper::PaperArms())
      if (!arm.warmup) names.emplace_back(arm.name);
    return names;
  }();
  return arms;
}

struct Token {
  enum class Kind { kEnd, kNumber, kName, kSymbol };
  Kind kind = Kind::kEnd;
  std::string_view text;
  std::size_t column = 1;
};

Quantity CellQuantity(std::string arm, std::size_t metric) {
  Quantity quantity;
  quantity.kind = Kind::kCell;
  quantity.cell = {std::move(arm), metric};
  return quantity;
}

Quantity Binary(Kind kind, Quantity left, Quantity right) {
  Quantity quantity;
  quantity.kind = kind;
  quantity.of.push_back(std::move(left));
  quantity.of.push_back(std::move(right));
  return quantity;
}

Quantity OfList(Kind kind, List list) {
  Quantity quantity;
  quantity.kind = kind;
  quantity.of = std::move(list);
  return quantity;
}

Formula Less(Quantity left, Quantity right) {
  return {.kind = Formula::Kind::kLess, .left = std::move(left), .right = std::move(right), .of = {}};
}

Formula Combine(Formula::Kind kind, std::vector<Formula> of) {
  if (of.size() == 1) return std::move(of.front());
  return {.kind = kind, .left = {}, .right = {}, .of = std::move(of)};
}

// "a dominates b": a spends less and succeeds more often.
Formula Dominates(const std::string& a, const std::string& b) {
  const std::size_t energy = metrics::MetricIndex("total_energy_kj"),
                    success = metrics::MetricIndex("msr_pct");
  return Combine(Formula::Kind::kAll, {Less(CellQuantity(a, energy), CellQuantity(b, energy)),
                                       Less(CellQuantity(b, success), CellQuantity(a, success))});
}

Formula DoesNotDominate(const std::string& a, const std::string& b) {
  const std::size_t energy = metrics::MetricIndex("total_energy_kj"),
                    success = metrics::MetricIndex("msr_pct");
  return Combine(Formula::Kind::kAny, {Less(CellQuantity(b, energy), CellQuantity(a, energy)),
                                       Less(CellQuantity(a, success), CellQuantity(b, success))});
}

class Parser {
 public:
  Parser(std::string_view text, std::string_view metric) : text_(text), metric_(metric) { Next(); }

  Expression Parse() {
    std::vector<Formula> parts;
    Expression expression;
    do {
      Formula part;
      if (ParsePart(part, expression.quantity))
        parts.push_back(std::move(part));
      else
        expression.is_quantity = true;
    } while (Accept(";"));
    if (token_.kind != Token::Kind::kEnd) Refuse("end of the claim");
    if (expression.is_quantity && !parts.empty()) Refuse("only comparisons beside other comparisons");
    if (expression.is_quantity) return expression;
    expression.formula = Combine(Formula::Kind::kAll, std::move(parts));
    return expression;
  }

 private:
  [[noreturn]] void Fail(std::size_t column, const std::string& what) const {
    throw UserError(fmt::format("{}:{}: {}", text_, column, what));
  }
  [[noreturn]] void Refuse(std::string_view expected) const {
    Fail(token_.column,
         fmt::format("expected {}, found {}", expected,
                     token_.kind == Token::Kind::kEnd ? "the end" : fmt::format("'{}'", token_.text)));
  }

  // Names may hold hyphens ("ed3r-75"), so a minus between arms stands between spaces.
  void Next() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    const std::size_t start = at_;
    token_ = {Token::Kind::kEnd, {}, start + 1};
    if (at_ == text_.size()) return;
    const auto is = [&](auto test) {
      return at_ < text_.size() && test(static_cast<unsigned char>(text_[at_]));
    };
    const auto in_name = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
    if (std::isdigit(static_cast<unsigned char>(text_[at_])) != 0) {
      token_.kind = Token::Kind::kNumber;
      while (is([](unsigned char c) { return std::isdigit(c) != 0; }) ||
             (is([](unsigned char c) { return c == '.'; }) && text_.substr(at_, 2) != ".."))
        ++at_;
    } else if (std::isalpha(static_cast<unsigned char>(text_[at_])) != 0) {
      token_.kind = Token::Kind::kName;
      while (is(in_name)) ++at_;
    } else {
      token_.kind = Token::Kind::kSymbol;
      at_ += text_.substr(at_, 2) == ".." ? 2 : 1;
    }
    token_.text = text_.substr(start, at_ - start);
  }

  bool Is(std::string_view symbol) const { return token_.kind != Token::Kind::kEnd && token_.text == symbol; }
  bool Accept(std::string_view symbol) {
    if (!Is(symbol)) return false;
    Next();
    return true;
  }
  void Expect(std::string_view symbol) {
    if (!Accept(symbol)) Refuse(fmt::format("'{}'", symbol));
  }

  // True for a statement; false for a single quantity.
  bool ParsePart(Formula& part, Quantity& quantity) {
    if (Accept("frontier")) return part = ParseFrontier(), true;
    if (Accept("dominated")) return part = ParseDominated(), true;
    List left = ParseList();
    if (!Is("<") && !Is(">") && !Is("~")) {
      if (left.size() != 1) Refuse("'<', '>' or '~' behind a list");
      quantity = std::move(left.front());
      return false;
    }
    std::vector<Formula> all;
    if (Accept("~")) {
      const List right = ParseList();
      for (const Quantity& a : left)
        for (const Quantity& b : right)
          all.push_back({.kind = Formula::Kind::kSimilar, .left = a, .right = b, .of = {}});
    } else {
      const std::string_view direction = token_.text;
      while (Accept(direction)) {
        List right = ParseList();
        for (const Quantity& a : left)
          for (const Quantity& b : right) all.push_back(direction == "<" ? Less(a, b) : Less(b, a));
        left = std::move(right);
      }
      if (Is("<") || Is(">")) Refuse(fmt::format("only '{}' in one chain", direction));
    }
    part = Combine(Formula::Kind::kAll, std::move(all));
    return true;
  }

  Formula ParseFrontier() {
    std::vector<Formula> all;
    for (const std::string& arm : ParseArmsInBrackets())
      for (const std::string& other : OnlineArms())
        if (other != arm) all.push_back(DoesNotDominate(other, arm));
    return Combine(Formula::Kind::kAll, std::move(all));
  }

  Formula ParseDominated() {
    const std::vector<std::string> inferior = ParseArmsInBrackets();
    Expect("by");
    const std::vector<std::string> superior = ParseArms();
    std::vector<Formula> all;
    for (const std::string& arm : inferior) {
      std::vector<Formula> any;
      for (const std::string& other : superior) any.push_back(Dominates(other, arm));
      all.push_back(Combine(Formula::Kind::kAny, std::move(any)));
    }
    return Combine(Formula::Kind::kAll, std::move(all));
  }

  std::vector<std::string> ParseArmsInBrackets() {
    Expect("(");
    std::vector<std::string> arms = ParseArms();
    Expect(")");
    return arms;
  }

  std::vector<std::string> ParseArms() {
    std::vector<std::string> arms;
    do {
      for (std::string& arm : ParseArmOrRange()) arms.push_back(std::move(arm));
    } while (Accept(","));
    return arms;
  }

  std::vector<std::string> ParseArmOrRange() {
    if (token_.kind != Token::Kind::kName) Refuse("an arm");
    const std::size_t column = token_.column;
    const std::string first(token_.text);
    CheckArm(first, column);
    Next();
    if (!Accept("..")) return {first};
    int last = 0;
    const auto [end, error] =
        std::from_chars(token_.text.data(), token_.text.data() + token_.text.size(), last);
    const int from = first.back() - '0';
    if (token_.kind != Token::Kind::kNumber || error != std::errc() ||
        end != token_.text.data() + token_.text.size() || last > 9 || last <= from)
      Refuse("a digit that is larger than the first");
    Next();
    std::vector<std::string> arms;
    for (int i = from; i <= last; ++i) {
      arms.push_back(first.substr(0, first.size() - 1) + std::to_string(i));
      CheckArm(arms.back(), column);
    }
    return arms;
  }

  void CheckArm(const std::string& name, std::size_t column) const {
    const std::vector<std::string>& arms = StudyArms();
    if (std::find(arms.begin(), arms.end(), name) != arms.end()) return;
    const std::string nearest = NearestWord(name, arms);
    Fail(column, fmt::format("'{}' is no arm{}", name,
                             nearest.empty() ? "" : fmt::format(" (nearest: {})", nearest)));
  }

  std::size_t FindMetric(std::string_view name, std::size_t column) const {
    std::vector<std::string> names;
    for (const metrics::MetricDefinition& metric : metrics::MetricDefinitions())
      names.emplace_back(metric.name);
    if (std::find(names.begin(), names.end(), name) != names.end()) return metrics::MetricIndex(name);
    const std::string nearest = NearestWord(name, names);
    Fail(column, fmt::format("'{}' is no metric{}", name,
                             nearest.empty() ? "" : fmt::format(" (nearest: {})", nearest)));
  }

  List ParseList() {
    List list;
    do {
      for (Quantity& quantity : ParseItem()) list.push_back(std::move(quantity));
    } while (Accept(","));
    return list;
  }

  // One quantity, or the arms of a range.
  List ParseItem() {
    const std::size_t at = at_;
    const Token token = token_;
    if (token_.kind == Token::Kind::kName) {
      Next();
      const bool range = Is("..");
      at_ = at, token_ = token;
      if (range) {
        List arms;
        const std::size_t metric = FindMetric(metric_, token.column);
        for (const std::string& arm : ParseArmOrRange()) arms.push_back(CellQuantity(arm, metric));
        return arms;
      }
    }
    return {ParseSum()};
  }

  Quantity ParseSum() {
    Quantity sum = ParseProduct();
    while (Is("+") || Is("-")) {
      const Kind kind = Is("+") ? Kind::kAdd : Kind::kSubtract;
      Next();
      Quantity right = ParseProduct();
      sum = Binary(kind, std::move(sum), std::move(right));
    }
    return sum;
  }

  Quantity ParseProduct() {
    Quantity product = ParseAtom();
    while (Is("*") || Is("/")) {
      const Kind kind = Is("*") ? Kind::kMultiply : Kind::kDivide;
      Next();
      Quantity right = ParseAtom();
      product = Binary(kind, std::move(product), std::move(right));
    }
    return product;
  }

  Quantity ParseAtom() {
    if (token_.kind == Token::Kind::kNumber) return ParseNumber();
    if (Accept("(")) {
      Quantity inner = ParseSum();
      Expect(")");
      return inner;
    }
    if (token_.kind != Token::Kind::kName) Refuse("a number, an arm or a metric");
    const Token name = token_;
    Next();
    if (!Is("(")) {
      CheckArm(std::string(name.text), name.column);
      return CellQuantity(std::string(name.text), FindMetric(metric_, name.column));
    }
    Next();
    Quantity quantity = ParseCall(name);
    Expect(")");
    return quantity;
  }

  Quantity ParseCall(const Token& name) {
    constexpr std::pair<std::string_view, Kind> kFunctions[] = {
        {"max", Kind::kMax}, {"min", Kind::kMin}, {"mean", Kind::kMean}};
    for (const auto& [function, kind] : kFunctions)
      if (name.text == function) return OfList(kind, ParseList());
    const std::size_t metric = FindMetric(name.text, name.column);
    const std::vector<std::string> arms = ParseArmOrRange();
    if (arms.size() != 1) Refuse("one arm");
    return CellQuantity(arms.front(), metric);
  }

  Quantity ParseNumber() {
    Quantity number;
    const char* end = token_.text.data() + token_.text.size();
    const auto [stop, error] = std::from_chars(token_.text.data(), end, number.number);
    if (error != std::errc() || stop != end) Refuse("a number");
    Next();
    return number;
  }

  std::string_view text_, metric_;
  std::size_t at_ = 0;
  Token token_;
};

}  // namespace

const std::vector<std::string>& StudyArms() {
  static const std::vector<std::string> arms = [] {
    std::vector<std::string> all = OnlineArms();
    for (const std::string& arm : OnlineArms()) all.push_back(paper::P85Name(arm));
    return all;
  }();
  return arms;
}

Expression ParseExpression(std::string_view text, std::string_view metric) {
  return Parser(text, metric).Parse();
}

}  // namespace ed3r::claims
