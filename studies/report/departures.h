// Whether a run flew what the paper did: its claims are judged only then.
//
// What counts follows from the parameters themselves: every parameter of a mission that differs from its default, or from
// what the paper's arm of that name has (strategy, threshold, sites in play), decides results, and a new parameter does so
// from its first day. The exceptions are effort, which changes how well something is known but not what: training.*, the
// numbers of missions, the scenarios' numbers. Pure functions, any thread.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::store {
class ResultReader;
}  // namespace ed3r::store

namespace ed3r::report {

struct Departure {
  std::string key;                  // of a parameter, or "missions of STAGE"
  std::vector<std::string> values;  // the different ones, in plan order
  std::string paper;                // the paper's, or the default
  std::vector<std::string> arms;    // those that have it; empty: all that it could be in
};

struct Departures {
  std::vector<Departure> results;  // of arms with the paper's names, and of what those learn from
  std::vector<Departure> aside;    // of arms with names of their own, of which no claim speaks
  std::vector<Departure> effort;

  bool PaperFlown() const { return results.empty(); }
};

// Of the flying arms of one variant ("": of a plan without variants). `paper_worlds`: what the plan calls worlds that
// are the paper's.
Departures DeparturesOf(std::string_view plan_text, const std::string& variant,
                        const std::set<std::string>& paper_worlds);

// By variant, "" in a run without variants.
using RunDepartures = std::map<std::string, Departures>;
RunDepartures ReadDepartures(store::ResultReader& reader);

// What a report does about claims.
enum class Judging {
  kWhatThePaperFlew,  // leaves verdicts out where results depart
  kEverything         // --claims
};

// "robot.mass_kg 2.4 for 1.816 in rbs; mission.world hills.yaml for worlds/paper.yaml"
std::string DepartureText(const std::vector<Departure>& departures);

// Sentences for the head of a report that tells `variant`: what departs, and what that does to the verdicts.
std::vector<std::string> DepartureSentences(const RunDepartures& departures, const std::string& variant,
                                            Judging judging);

// {"paper_flown", "claims_judged", "results", "aside", "effort"}; each entry {"parameter", "values", "paper", "arms"}.
nlohmann::ordered_json DeparturesJson(const Departures& departures, Judging judging);

}  // namespace ed3r::report
