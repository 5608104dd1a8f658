#include "engine/sweep/condition.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <type_traits>
#include <utility>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/core/suggest.h"

namespace ed3r::sweep {
namespace {

enum class Relation { kEqual, kNotEqual, kLess, kLessOrEqual, kGreater, kGreaterOrEqual };

struct Operand {
  bool is_parameter = false;
  std::string text;  // key or value
};

struct Token {
  enum class Kind { kWord, kQuoted, kRelation, kOpen, kClose, kEnd };
  Kind kind = Kind::kEnd;
  std::string text;
  std::size_t offset = 0;
};

// Whether a parameter is a number, found in the structs' own description.
class NumberFinder {
 public:
  explicit NumberFinder(const std::string& key) : key_(key) {}

  template <class T>
  void operator()(std::string_view name, const T&, const FieldInfo&) {
    if (prefix_ + std::string(name) == key_)
      is_number = std::is_arithmetic_v<T> && !std::is_same_v<std::remove_cv_t<T>, bool>;
  }

  template <class T>
  void Nested(std::string_view name, const T& subject) {
    const std::size_t length = prefix_.size();
    prefix_ += std::string(name) + ".";
    T::Describe(subject, *this);
    prefix_.resize(length);
  }

  bool is_number = false;

 private:
  std::string key_;
  std::string prefix_;
};

bool IsNumber(const std::string& key) {
  const Config config;
  NumberFinder finder(key);
  Config::Describe(config, finder);
  return finder.is_number;
}

bool IsMissionParameter(const std::string& key) {
  const auto& list = Parameters();
  return std::any_of(list.begin(), list.end(), [&](const ParameterInfo& parameter) {
    return parameter.key == key && parameter.scope == Scope::kMission;
  });
}

bool IsReserved(const std::string& word) { return word == "and" || word == "or" || word == "not"; }

double NumberFrom(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  ED3R_CHECK(error == std::errc() && end == text.data() + text.size(), text);
  return value;
}

// One file has many names; a word that stands in a file's place is itself.
std::string FileCalled(const std::string& name) {
  std::error_code error;
  const std::filesystem::path file = std::filesystem::canonical(name, error);
  return error ? name : file.string();
}

template <class T>
bool Compares(const T& a, Relation relation, const T& b) {
  switch (relation) {
    case Relation::kEqual:
      return a == b;
    case Relation::kNotEqual:
      return a != b;
    case Relation::kLess:
      return a < b;
    case Relation::kLessOrEqual:
      return a <= b;
    case Relation::kGreater:
      return a > b;
    case Relation::kGreaterOrEqual:
      return a >= b;
  }
  FailCheck(__FILE__, __LINE__, "known relation", std::to_string(static_cast<int>(relation)));
}

}  // namespace

// One node of the parsed condition.
struct Condition::Expression {
  enum class Kind { kOr, kAnd, kNot, kComparison };
  using Pointer = std::unique_ptr<const Expression>;

  Kind kind = Kind::kComparison;
  Pointer left, right;  // of or, and; `not` has only a left one
  Operand a, b;         // of a comparison
  Relation relation = Relation::kEqual;
  bool numbers = false, files = false;

  bool Holds(const Config& config) const {
    switch (kind) {
      case Kind::kOr:
        return left->Holds(config) || right->Holds(config);
      case Kind::kAnd:
        return left->Holds(config) && right->Holds(config);
      case Kind::kNot:
        return !left->Holds(config);
      case Kind::kComparison:
        break;
    }
    const std::string x = a.is_parameter ? GetParameter(config, a.text) : a.text;
    const std::string y = b.is_parameter ? GetParameter(config, b.text) : b.text;
    if (numbers) return Compares(NumberFrom(x), relation, NumberFrom(y));
    return files ? Compares(FileCalled(x), relation, FileCalled(y)) : Compares(x, relation, y);
  }
};

namespace {

using Expression = Condition::Expression;

// Recursive descent, one method per level of binding.
class Parser {
 public:
  Parser(const YamlNode& node, const SettingReader& reader)
      : text_(TextOf(node, "where")), at_(node.at), reader_(reader) {
    Advance();
  }

  Expression::Pointer Parse() {
    Expression::Pointer whole = Or();
    if (token_.kind != Token::Kind::kEnd) Refuse("'and', 'or' or the end");
    return whole;
  }

 private:
  [[noreturn]] void Refuse(std::string_view allowed) const {
    FailAt(at_, fmt::format("where: {} is not allowed at character {} of the condition; allowed: {}",
                            token_.kind == Token::Kind::kEnd ? "its end" : "'" + token_.text + "'",
                            token_.offset + 1, allowed));
  }

  void Advance() {
    const std::size_t start = std::min(text_.find_first_not_of(" \t", next_), text_.size());
    token_ = {Token::Kind::kEnd, "", start};
    next_ = start;
    if (start == text_.size()) return;
    const char c = text_[start];
    std::size_t end = start + 1;
    if (c == '(' || c == ')') {
      token_.kind = c == '(' ? Token::Kind::kOpen : Token::Kind::kClose;
    } else if (c == '\'' || c == '"') {
      const std::size_t closing = text_.find(c, end);
      token_ = {Token::Kind::kQuoted, text_.substr(start), start};
      if (closing == std::string::npos) Refuse(fmt::format("text that ends with {}", c));
      token_ = {Token::Kind::kQuoted, text_.substr(end, closing - end), start};
      next_ = closing + 1;
      return;
    } else {
      constexpr std::string_view kRelationSigns = "=!<>";
      const bool relation = kRelationSigns.find(c) != std::string_view::npos;
      token_.kind = relation ? Token::Kind::kRelation : Token::Kind::kWord;
      end = std::min(relation ? text_.find_first_not_of(kRelationSigns, start)
                              : text_.find_first_of(" \t()'\"=!<>", start),
                     text_.size());
    }
    token_.text = text_.substr(start, end - start);
    next_ = end;
  }

  bool TakeWord(std::string_view word) {
    if (token_.kind != Token::Kind::kWord || token_.text != word) return false;
    Advance();
    return true;
  }

  static Expression::Pointer Joined(Expression::Kind kind, Expression::Pointer left,
                                    Expression::Pointer right) {
    auto expression = std::make_unique<Expression>();
    expression->kind = kind;
    expression->left = std::move(left);
    expression->right = std::move(right);
    return expression;
  }

  Expression::Pointer Or() {
    Expression::Pointer left = And();
    while (TakeWord("or")) left = Joined(Expression::Kind::kOr, std::move(left), And());
    return left;
  }

  Expression::Pointer And() {
    Expression::Pointer left = Not();
    while (TakeWord("and")) left = Joined(Expression::Kind::kAnd, std::move(left), Not());
    return left;
  }

  Expression::Pointer Not() {
    if (TakeWord("not")) return Joined(Expression::Kind::kNot, Not(), nullptr);
    if (token_.kind != Token::Kind::kOpen) return Comparison();
    Advance();
    Expression::Pointer inner = Or();
    if (token_.kind != Token::Kind::kClose) Refuse("'and', 'or' or ')'");
    Advance();
    return inner;
  }

  Expression::Pointer Comparison() {
    const Token left = TakeOperand();
    const Token sign = token_;
    const Relation relation = TakeRelation();
    const Token right = TakeOperand();
    auto comparison = std::make_unique<Expression>();
    comparison->relation = relation;
    comparison->a = {Names(left), Names(left) ? FullKey(left.text) : left.text};
    comparison->b = {Names(right), Names(right) ? FullKey(right.text) : right.text};
    if (!Names(left) && !Names(right)) RefuseUnknown(left, right);
    CheckTypes(*comparison, sign.text);
    return comparison;
  }

  Token TakeOperand() {
    const bool is_operand = token_.kind == Token::Kind::kQuoted ||
                            (token_.kind == Token::Kind::kWord && !IsReserved(token_.text));
    if (!is_operand) Refuse("a parameter or a value");
    Token operand = token_;
    Advance();
    return operand;
  }

  Relation TakeRelation() {
    constexpr std::array<std::pair<std::string_view, Relation>, 6> kSigns = {{
        {"==", Relation::kEqual},
        {"!=", Relation::kNotEqual},
        {"<", Relation::kLess},
        {"<=", Relation::kLessOrEqual},
        {">", Relation::kGreater},
        {">=", Relation::kGreaterOrEqual},
    }};
    if (token_.kind == Token::Kind::kRelation) {
      for (const auto& [sign, relation] : kSigns) {
        if (token_.text != sign) continue;
        Advance();
        return relation;
      }
    }
    Refuse("== != < <= > >=");
  }

  static bool Names(const Token& token) {
    return token.kind == Token::Kind::kWord && IsMissionParameter(FullKey(token.text));
  }

  [[noreturn]] void RefuseUnknown(const Token& left, const Token& right) const {
    std::string nearest = NearestWord(left.text, ParameterKeys());
    if (nearest.empty()) nearest = NearestWord(right.text, ParameterKeys());
    FailAt(at_,
           fmt::format("where: neither '{}' nor '{}' is a parameter of a mission; {}", left.text, right.text,
                       nearest.empty() ? "'ed3r params' lists all" : "did you mean " + nearest + "?"));
  }

  // Both sides must be of one type; a value must be one that the parameter may have.
  void CheckTypes(Expression& comparison, const std::string& sign) const {
    Operand& a = comparison.a;
    Operand& b = comparison.b;
    const std::string& key = a.is_parameter ? a.text : b.text;
    comparison.numbers = IsNumber(key);
    comparison.files = NamesAFile(key);
    if (a.is_parameter && b.is_parameter) {
      if (IsNumber(b.text) != comparison.numbers)
        FailAt(at_, fmt::format("where: {} and {} cannot be compared: one is a number", a.text, b.text));
    } else {
      Operand& value = a.is_parameter ? b : a;
      value.text = reader_.Read(key, at_, value.text, at_).text;
    }
    if (!comparison.numbers && comparison.relation != Relation::kEqual &&
        comparison.relation != Relation::kNotEqual)
      FailAt(at_,
             fmt::format("where: '{}' is not allowed for {}, which is no number; allowed: == !=", sign, key));
  }

  std::string text_;
  std::string at_;
  const SettingReader& reader_;
  std::size_t next_ = 0;
  Token token_;
};

}  // namespace

Condition Condition::Parse(const YamlNode& node, const SettingReader& reader) {
  Condition condition;
  condition.root_ = Parser(node, reader).Parse();
  condition.at_ = node.at;
  return condition;
}

bool Condition::Holds(const Config& config) const { return root_->Holds(config); }

std::vector<Condition> ReadConditions(const YamlNode& where, const SettingReader& reader) {
  std::vector<Condition> conditions;
  if (where.kind == YamlNode::Kind::kScalar) {
    conditions.push_back(Condition::Parse(where, reader));
    return conditions;
  }
  if (where.kind != YamlNode::Kind::kList)
    FailAt(where.at,
           fmt::format("where: {} is not allowed; allowed: a condition or a list of them", Described(where)));
  for (const YamlNode& item : where.items) conditions.push_back(Condition::Parse(item, reader));
  return conditions;
}

}  // namespace ed3r::sweep
