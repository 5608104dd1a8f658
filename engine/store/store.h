// Results on disk: one SQLite file, DIR/results.sqlite, with the recipe, missions and timesteps of a run.
// This is the writing side; reader.h is the reading side and may look on while this one writes.
//
// Threads: one ResultStore is used by one thread at a time (the scheduler's writer).
// Errors: UserError for a directory that holds another recipe, is not a store, or has another writer;
// StoreError when the disk fails or is full. After an error only what was committed is kept, and every
// further call throws.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/mission/record.h"
#include "engine/store/damage.h"
#include "engine/store/layout.h"
#include "engine/store/networks.h"
#include "engine/store/recipe.h"
#include "engine/store/records.h"
#include "engine/store/store_file.h"

namespace ed3r::store {

class ResultStore {
 public:
  // Makes DIR and the file when missing, continues it when there; begins a session with recipe.notes. A plan that asks for
  // more missions or arms than the file's, and leaves those there as they are, takes its place (growth.h) together with the
  // first mission, failure or network that is put, so that a run that is refused before keeps its plan; `taking` says what
  // becomes of damaged missions then. Until then other readers see the file's own plan, and this object what it will be.
  static std::unique_ptr<ResultStore> Open(const std::string& dir, const Recipe& recipe,
                                           const RunLayout& layout, const Taking& taking = {});

  // Ends the session. What was not committed is dropped.
  virtual ~ResultStore() = default;

  virtual const RunLayout& Layout() const = 0;

  // What the plan has got since the last session: "stage online: 20 missions per arm for 10"; "" where it is the same.
  virtual std::string Grown() const = 0;
  // False until the file has it.
  virtual bool HasGrown() const = 0;
  // Grows now, and keeps it: a run that has ended well with nothing to fly has the plan that it was asked for.
  virtual void Grow() = 0;

  // Damaged missions that were taken out so that the plan may grow.
  virtual std::vector<DamagedMission> Repaired() const = 0;

  // Finished missions in plan order. Failed ones are not among them: they are flown again. UserError when one is not in
  // the plan.
  virtual std::vector<sweep::RunId> Stored() const = 0;

  // Missions that have failed and not been flown since, in plan order.
  virtual std::vector<sweep::RunId> Failed() const = 0;

  // UserError where one of them is damaged.
  virtual FlownNetworks Networks() const = 0;

  // A mission is stored once; wall_s is kept apart from the results. A record whose timesteps are not
  // numbered upwards is an InternalError.
  virtual void Put(const sweep::RunId& id, const mission::MissionRecord& record, double wall_s) = 0;

  // A mission that threw. Its scenario and seed are filled in from the layout; replaced by a later failure,
  // removed by a later Put.
  virtual void PutFailure(const sweep::RunId& id, const Failure& failure) = 0;

  // Missions that do not match their checksums or are not in the plan (damage.h); and out with them, so that they are
  // flown again. Call them before anything is put.
  virtual std::vector<DamagedMission> FindDamage() = 0;
  virtual void Remove(const std::vector<DamagedMission>& missions) = 0;

  // The networks of the arms that fly next. UserError when one of them has flown with another.
  virtual void PutNetworks(const FlownNetworks& networks) = 0;

  // On this session, beside recipe.notes; a note of the same name is replaced.
  virtual void PutNote(const std::string& name, const std::string& text) = 0;

  virtual void Commit() = 0;  // everything put so far survives a kill

  // For a run that is refused: takes away the file that Open has made, and folders, where no mission, failure or network
  // has come into it. The store is closed then.
  virtual void DiscardUnused() {}
};

}  // namespace ed3r::store
