#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/task_board.h"
#include "engine/codec/level_codec.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/pipeline/certify.h"
#include "engine/pipeline/level_attributes.h"
#include "engine/pipeline/reconstruct.h"

namespace geosis {

/// What finishing a level takes.
struct FinishOptions {
  AttributeSources sources;
  bool keep_reliability = true;  ///< as an attribute; it is needed for the interpolated share anyway
  EncodeOptions encode;
  CertifyOptions certify;
};

/// Levels on their way from simplified to finished: given their attributes, encoded part by part, decoded again and
/// described, by the thread that waits for them and by spare ones. Coarser levels go before finer ones.
class LevelFinisher {
 public:
  /// m0   a level that is this very mesh is not needed decoded once it is described.
  LevelFinisher(const FinishOptions& options, const IndexedMesh& m0, int helpers, const Progress& progress);
  ~LevelFinisher();

  /// The level can be worked on from now on, by spare threads at once; level and mesh stay where they are.
  ///
  /// mesh   the level's, which may be kept elsewhere than in level.lod.
  void add(std::size_t number, ReconstructedLevel& level, const IndexedMesh& mesh);

  /// Works along until the level has its attributes, bytes, topology and measures.
  ///
  /// errors   those of attributes_of, encode_level and decode_level.
  Result<void> finish(std::size_t number);

  /// What the finished level decodes to; empty for M0.
  const IndexedMesh& decoded(std::size_t number) const;

  /// For tasks that are less urgent than any level's.
  TaskBoard& board() { return board_; }

 private:
  struct Work;

  void begin(Work& work);
  void begin_next();
  void prepare(Work& work);
  void code_part(Work& work, std::size_t part);
  void join_and_describe(Work& work);
  void end(Work& work, Result<void> result);
  Work* find(std::size_t number) const;

  const FinishOptions options_;
  const IndexedMesh& m0_;
  const Progress& progress_;
  const bool has_helpers_;
  mutable std::mutex mutex_;  // of works_ and of each work's `begun`, and of in_flight_
  std::vector<std::unique_ptr<Work>> works_;
  int in_flight_ = 0;  // levels that have begun and not ended
  TaskBoard board_;    // last: its tasks use all of the above
};

}  // namespace geosis
