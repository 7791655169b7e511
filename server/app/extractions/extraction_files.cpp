#include <span>
#include <string>
#include <utility>

#include "engine/base/digest.h"
#include "engine/pipeline/describe_bodies.h"
#include "server/app/extractions/extraction_blobs.h"
#include "server/app/extractions/extractions.h"
#include "server/app/extractions/level_export.h"
#include "server/app/extractions/result_streams.h"
#include "server/documents/manifest.h"
#include "server/store/piece_sums.h"

// What of an extraction is read as files: parts, whole levels, the bodies. Files that were not there are made first.

namespace geosis::server {
namespace {

constexpr std::size_t kMostChecked = 1024;

Error not_done(const std::string& id, JobState state) {
  return {ErrorCode::already_exists, "extraction " + id + ": it is " + name_of(state) + ", not done"};
}

Result<void> wait_until_made(const Result<std::shared_ptr<Job>>& job) {
  if (!job) return job.error();
  while (!(*job)->wait_for(std::chrono::hours(1))) {
  }
  return (*job)->outcome();
}

bool has_part(const Extraction::Snapshot& now, int level, int part) {
  for (const Json& entry : now.levels) {
    if (entry.at("level") == level) return part >= 0 && part < static_cast<int>(entry.at("parts").size());
  }
  return false;
}

LevelFile bytes_file(std::vector<std::byte> bytes) {
  LevelFile file{.sha256 = sha256_hex(bytes), .bytes = bytes.size(), .stream = nullptr, .transform = {}};
  file.stream = bytes_stream(std::move(bytes));
  return file;
}

}  // namespace

/// The extraction, if it is done.
Result<std::shared_ptr<Extraction>> Extractions::find_done(const std::string& id) {
  auto extraction = find(id);
  if (!extraction) return extraction;
  const JobState state = (*extraction)->snapshot().state;
  if (state != JobState::done) return not_done(id, state);
  return extraction;
}

Result<LevelFile> Extractions::bodies(const std::string& id) {
  if (auto done = find_done(id); !done) return std::move(done).error();
  auto bytes = store_.get(key(id, kBodies));
  if (!bytes && bytes.error().code == ErrorCode::not_found) {
    if (auto made = wait_until_made(begin_bodies(id)); !made) return std::move(made).error();
    bytes = store_.get(key(id, kBodies));
  }
  // Damaged: described again when next asked for.
  if (!bytes && bytes.error().code == ErrorCode::internal) static_cast<void>(store_.remove(key(id, kBodies)));
  if (!bytes) return std::move(bytes).error();
  return bytes_file(*std::move(bytes));
}

bool Extractions::are_bodies_made(const std::string& id) {
  const auto made = store_.exists(key(id, kBodies));
  return made && *made;
}

Result<std::shared_ptr<Job>> Extractions::begin_bodies(const std::string& id) {
  const auto extraction = find_done(id);
  if (!extraction) return extraction.error();
  if ((*extraction)->identity().request.value("preview", false)) {
    return Error{ErrorCode::unsupported, "extraction " + id + ": it is a preview, whose bodies are not described"};
  }
  return begin((*extraction)->identity(), kBodies,
               [this, extraction = *extraction](Job& running) { return make_bodies(extraction->identity(), running); });
}

Result<void> Extractions::make_bodies(const Extraction::Identity& identity, Job& running) {
  ExtractionTimings unread;
  const auto opened = open(identity, running, unread);
  if (!opened) return opened.error();
  const ExtractionInput input = opened->input();
  const auto bodies = describe_bodies(reconstruct_input(input, opened->options), opened->options, running);
  if (!bodies) return bodies.error();
  return write_document(key(identity.id, kBodies), bodies_document(input.volume, opened->options, *bodies));
}

Result<LevelFile> Extractions::part(const std::string& id, int level, int part) {
  const auto extraction = find(id);
  if (!extraction) return extraction.error();
  if (!has_part((*extraction)->snapshot(), level, part)) {
    return Error{ErrorCode::not_found,
                 "extraction " + id + ": no part " + std::to_string(part) + " of level " + std::to_string(level)};
  }
  auto bytes = (*extraction)->read_part(level, part);
  if (bytes) return bytes_file(*std::move(bytes));
  if (bytes.error().code != ErrorCode::not_found) return std::move(bytes).error();
  return Error{ErrorCode::unavailable, "extraction " + id + ": its parts were removed; it is computed again"};
}

Result<std::string> read_whole(LevelFile& file) {
  std::string bytes(file.bytes, '\0');
  std::size_t count = 0;
  while (count < bytes.size()) {
    const auto pulled = file.stream->pull(std::as_writable_bytes(std::span(bytes).subspan(count)));
    if (!pulled) return pulled.error();
    if (pulled->state != ByteStream::Pulled::State::data) break;
    count += pulled->count;
  }
  if (count == bytes.size() && sha256_hex(std::as_bytes(std::span(bytes))) == file.sha256) return bytes;
  return Error{ErrorCode::internal, "a stored file is damaged"};
}

std::optional<LevelFormat> level_format_of(std::string_view extension) {
  using enum LevelFormat;
  for (const LevelFormat format : {drc, glb, ply, obj, stl}) {
    if (extension == extension_of(format)) return format;
  }
  return std::nullopt;
}

std::string extension_of(LevelFormat format) {
  switch (format) {
    case LevelFormat::drc:
      return "drc";
    case LevelFormat::glb:
      return "glb";
    case LevelFormat::ply:
      return "ply";
    case LevelFormat::obj:
      return "obj";
    case LevelFormat::stl:
      return "stl";
  }
  return "";
}

bool Extractions::has_result(const std::string& id) const {
  const auto is_done = store_.exists(key(id, kManifest));
  return is_done && *is_done;
}

bool Extractions::is_level_made(const std::string& id, int level, LevelFormat format) {
  const auto made = store_.exists(key(id, level_file_name(level, format) + ".json"));
  if (made && *made) return true;
  const auto more = store_.exists(key(id, part_name(level, 1)));
  return format == LevelFormat::drc && more && !*more;  // one part is the whole level
}

/// The manifest of an extraction that is done and has this level.
Result<Json> Extractions::manifest_with_level(const std::string& id, int level) {
  const auto extraction = find(id);
  if (!extraction) return extraction.error();
  Extraction::Snapshot now = (*extraction)->snapshot();
  if (!now.manifest) return not_done(id, now.state);
  const std::size_t levels = now.manifest->at("levels").size();
  if (level < 0 || level >= static_cast<int>(levels)) {
    return Error{ErrorCode::not_found,
                 "extraction " + id + ": no level " + std::to_string(level) + "; it has " + std::to_string(levels)};
  }
  return *std::move(now.manifest);
}

Result<LevelFile> Extractions::level(const std::string& id, int level, LevelFormat format) {
  const auto manifest = manifest_with_level(id, level);
  if (!manifest) return manifest.error();
  const Json& entry = manifest->at("levels").at(static_cast<std::size_t>(level));
  auto file =
      format == LevelFormat::drc && entry.at("parts").size() == 1 ? part(id, level, 0) : whole_level(id, level, format);
  if (file && format == LevelFormat::drc) file->transform = transform_text(manifest->at("transform"));
  return file;
}

/// The stored whole file; made first if nobody has asked for it yet.
Result<LevelFile> Extractions::whole_level(const std::string& id, int level, LevelFormat format) {
  const std::string name = level_file_name(level, format);
  auto description = read_document(id, (name + ".json").c_str());
  if (!description && description.error().code == ErrorCode::internal) forget_level(id, name);
  if (!description) {
    if (description.error().code != ErrorCode::not_found) return std::move(description).error();
    if (auto made = wait_until_made(begin_level(id, level, format)); !made) return std::move(made).error();
    description = read_document(id, (name + ".json").c_str());
    if (!description) return std::move(description).error();
  }
  return described_level(id, name, *description);
}

/// A stored whole file, if it is the one that was described. One that is not is made again when next asked for.
Result<LevelFile> Extractions::described_level(const std::string& id, const std::string& name,
                                               const Json& description) {
  const BlobKey file = key(id, name);
  const auto path = store_.local_file(file);
  if (!path) {
    forget_level(id, name);
    return path.error();
  }
  auto sums = description.value("sums", Json::array()).get<std::vector<std::uint64_t>>();
  const auto damaged = [this, id, name, file] {
    store_.report_damage(file, "its checksum does not match its bytes");
    forget_level(id, name);
  };
  const FileIdentity identity = identity_of(*path);
  bool is_checked = false;
  {
    const std::lock_guard lock(mutex_);
    const auto known = checked_files_.find(file);
    is_checked = known != checked_files_.end() && known->second == identity;
  }
  if (!is_checked) {
    const auto now = sums_of_file(*path);
    if (!now) return now.error();
    if (*now != sums) {
      damaged();
      return Error{ErrorCode::internal, "extraction " + id + ": a stored file is damaged; it is made again"};
    }
    const std::lock_guard lock(mutex_);
    if (checked_files_.size() >= kMostChecked) checked_files_.clear();
    checked_files_[file] = identity;
  }
  auto stream = file_stream(*path, std::move(sums), damaged);
  if (!stream) return std::move(stream).error();
  return LevelFile{.sha256 = description.at("sha256").get<std::string>(),
                   .bytes = description.at("bytes").get<std::uint64_t>(),
                   .stream = *std::move(stream),
                   .transform = {}};
}

void Extractions::forget_level(const std::string& id, const std::string& name) {
  static_cast<void>(store_.remove(key(id, name + ".json")));
}

Result<std::shared_ptr<Job>> Extractions::begin_level(const std::string& id, int level, LevelFormat format) {
  auto manifest = manifest_with_level(id, level);
  if (!manifest) return std::move(manifest).error();
  const Extraction::Identity identity{id, manifest->at("volume").get<std::string>(), "", manifest->at("request")};
  return begin(identity, level_file_name(level, format),
               [this, id, level, format, manifest = *std::move(manifest)](Job& running) {
                 return make_level_file(id, level, format, manifest, running);
               });
}

Result<void> Extractions::make_level_file(const std::string& id, int level, LevelFormat format, const Json& manifest,
                                          Job& running) {
  auto staged = store_.stage();
  if (!staged) return std::move(staged).error();
  auto description = export_level((*staged)->path(), manifest, level, format, part_reader(id), threads_, running);
  if (!description) return std::move(description).error();
  const std::string name = level_file_name(level, format);
  if (auto done = store_.commit(*std::move(staged), key(id, name)); !done) return done;
  return write_document(key(id, name + ".json"), *description);
}

/// On a worker, as all that computes. Who asks for what is being made waits for the same job.
Result<std::shared_ptr<Job>> Extractions::begin(const Extraction::Identity& identity, const std::string& name,
                                                JobQueue::Work work) {
  const BlobKey made = key(identity.id, name);
  JobDemand demand = demand_of(identity, Priority::interactive);
  demand.what += ", " + name;
  const std::lock_guard lock(mutex_);
  std::erase_if(making_, [](const auto& entry) { return entry.second.expired(); });
  if (const auto running = making_[made].lock(); running && !is_final(running->status().state)) return running;
  auto job = queue_.submit(std::move(demand), std::move(work));
  if (job) making_[made] = *job;
  return job;
}

}  // namespace geosis::server
