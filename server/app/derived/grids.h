#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/formats/positions.h"
#include "engine/volume/node_file.h"
#include "server/app/derived/file_identity.h"
#include "server/documents/json_text.h"
#include "server/documents/volume_document.h"
#include "server/store/blob_store.h"

namespace geosis::server {

struct AddedGrid {
  bool is_new = true;  ///< false: the same grid was here already
  Json document;
};

/// Grids whose nodes somebody has placed, of the volumes of a tenant: stored once, never changed, removed only when
/// somebody says so. Any thread of any process on the store may call any member.
///
/// Stored under <tenant>/volumes/<volume>/grids/<id>/: `nodes-<upload>`, a node file, and `grid.json`, which names that
/// file, written last and removed first.
class Grids {
 public:
  /// threads   that looking at one grid may use.
  Grids(BlobStore& store, std::string tenant, int threads);

  /// Stores the grid that a file of positions makes; the file may still arrive.
  ///
  /// confirm   asked once the file is read, before anything of it is kept.
  /// errors    those of import_positions, of confirm and of the store.
  Result<AddedGrid> add(const VolumeSummary& volume, const ByteSource& positions, const PositionFormat& format,
                        const std::function<Result<void>()>& confirm, Progress& progress);
  /// Stores the grid whose coordinates are the samples of these volumes, or where there is none the survey's own.
  ///
  /// errors    those of place_nodes and of the store.
  Result<AddedGrid> place(const VolumeSummary& volume, const std::array<const BrickedVolume*, 3>& coordinates,
                          Progress& progress);

  /// The grid, mapped. errors: not_found.  internal: what is stored of it is damaged.
  Result<std::shared_ptr<const NodeGrid>> open(const VolumeSummary& volume, const std::string& id);
  /// The grid's document of the outside contract. errors: as open().
  Result<Json> document(const std::string& volume, const std::string& id) const;
  /// {"grids": [...], "next_page_token": string or null}, in the order of ids.
  Result<Json> list(const std::string& volume, std::size_t page_size, const std::string& page_token) const;
  /// errors: not_found.
  Result<void> remove(const std::string& volume, const std::string& id);

  /// All grids of a volume that goes.
  Result<void> remove_all(const std::string& volume);
  /// Removes the files that processes which are gone left without a grid.json.
  Result<void> collect_garbage_of(const std::string& volume);

 private:
  struct Opened {
    BlobKey file;
    FileIdentity identity;
    std::shared_ptr<const NodeGrid> grid;
  };

  BlobKey folder(const std::string& volume) const { return tenant_ + "/volumes/" + volume + "/grids/"; }
  BlobKey folder(const std::string& volume, const std::string& id) const { return folder(volume) + id + "/"; }
  Result<Json> read(const std::string& volume, const std::string& id) const;
  Result<AddedGrid> keep(const VolumeSummary& volume, const NodeSummary& grid, const std::string& kind,
                         std::unique_ptr<StagedFile> file);
  Result<bool> store(const VolumeSummary& volume, const NodeSummary& grid, const std::string& kind,
                     std::unique_ptr<StagedFile> file);
  std::shared_ptr<const NodeGrid> recent(const BlobKey& file);
  void remember(Opened opened);
  Result<void> forget(const BlobKey& folder);
  Result<void> remove_files(const std::string& volume, const std::string& id);

  BlobStore& store_;
  const std::string tenant_;
  const int threads_;
  std::mutex mutex_;          // of recent_
  std::list<Opened> recent_;  ///< most recently used first
};

}  // namespace geosis::server
