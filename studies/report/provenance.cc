#include "studies/report/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "engine/core/files/file.h"
#include "engine/core/files/utf8.h"
#include "engine/store/reader.h"
#include "engine/store/recipe.h"

namespace ed3r::report {
namespace {

bool Flew(const store::Session& session) { return session.missions > 0; }

std::string Note(const std::map<std::string, std::string>& notes, const std::string& key) {
  const auto found = notes.find(key);
  return found == notes.end() ? "" : found->second;
}

// The sweep file as it is called from here, where it lies below the present folder.
std::string SweepFileOf(const std::map<std::string, std::string>& notes) {
  const std::string file = Note(notes, "sweep file");
  const std::string here =
      std::filesystem::path(file).lexically_proximate(std::filesystem::current_path()).string();
  return file.empty() || here.starts_with("..") ? file : here;
}

std::string CommandOf(const std::map<std::string, std::string>& notes, const std::string& dir) {
  if (!notes.contains("sweep file")) return "";
  std::string command = "ed3r run " + SweepFileOf(notes);
  for (const char* option : {"--seed", "--missions", "--set"}) {
    std::istringstream values(Note(notes, std::string("sweep ") + option));
    for (std::string value; std::getline(values, value);) command += std::string(" ") + option + " " + value;
  }
  return command + " --out " + dir;
}

// The first line's comment is a sweep file's question. Runs of before keep no note of it.
std::string QuestionOf(const std::map<std::string, std::string>& notes) {
  if (notes.contains("sweep question")) return Note(notes, "sweep question");
  std::string text, ignored;
  if (!TryReadFile(Note(notes, "sweep file"), kMaxTextBytes, text, ignored) || !text.starts_with("#"))
    return "";
  const std::string line = text.substr(1, text.find('\n') - 1);
  const std::size_t first = line.find_first_not_of(" \t");
  return first == std::string::npos || !IsUtf8(line) ? "" : line.substr(first);
}

std::vector<std::pair<std::string, std::string>> BrokenMissions(store::ResultReader& reader) {
  std::vector<std::pair<std::string, std::string>> broken;
  for (const store::FailedMission& failure : reader.Failures()) {
    const store::RunLayout::Stage& stage =
        reader.Layout().stages.at(static_cast<std::size_t>(failure.id.stage));
    broken.emplace_back(
        fmt::format("{}/{}/{}", stage.name, stage.arms.at(static_cast<std::size_t>(failure.id.arm)).name,
                    failure.id.mission),
        failure.message);
  }
  return broken;
}

}  // namespace

Provenance ReadProvenance(store::ResultReader& reader, const std::string& digest, const std::string& called) {
  Provenance provenance;
  provenance.dir = called;
  provenance.sweep = reader.Layout().name;
  provenance.seed = std::to_string(reader.Layout().seed);
  provenance.code_version = store::CodeText(reader.StoredRecipe().code);
  provenance.mixed_code = store::MixedCode(reader.StoredRecipe().code);
  provenance.unchecked = !reader.Tables().checked();
  provenance.inputs = reader.StoredRecipe().inputs;
  const std::vector<store::Session> all = reader.Sessions();
  const bool any_flew = std::any_of(all.begin(), all.end(), Flew);
  for (const store::Session& session : all)
    if (Flew(session) || !any_flew) {
      provenance.sessions.push_back({session.host, session.begun_utc, session.ended_utc, session.notes});
      if (session.notes.contains(store::kProfileNote))
        provenance.time_by_phase = Note(session.notes, store::kProfileNote);
    }
  if (!provenance.sessions.empty()) {
    const std::map<std::string, std::string>& notes = provenance.sessions.back().notes;
    provenance.sweep_file = SweepFileOf(notes);
    provenance.command = CommandOf(notes, called);
    provenance.question = QuestionOf(notes);
    provenance.commit = Note(notes, "commit");
  }
  provenance.status = reader.Status();
  provenance.broken = BrokenMissions(reader);
  for (const store::ArmStatus& arm : provenance.status) {
    provenance.planned += arm.planned, provenance.stored += arm.done, provenance.failed += arm.failed;
    provenance.simulated_h += arm.simulated_s / 3600, provenance.wall_h += arm.wall_s / 3600;
  }
  provenance.digest = digest;
  return provenance;
}

nlohmann::ordered_json ManifestJson(const Provenance& p) {
  nlohmann::ordered_json machine = nlohmann::ordered_json::object();
  if (!p.sessions.empty())
    for (const auto& [key, value] : p.sessions.back().notes)
      if (!key.starts_with("sweep ") && key != "commit") machine[key] = value;
  return {{"sweep", p.sweep},       {"command", p.command}, {"seed", p.seed},
          {"code", p.code_version}, {"commit", p.commit},   {"digest", p.digest},
          {"missions", p.stored},   {"failed", p.failed},   {"simulated_h", p.simulated_h},
          {"wall_h", p.wall_h},     {"inputs", p.inputs},   {"machine", machine}};
}

}  // namespace ed3r::report
