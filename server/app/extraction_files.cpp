#include <string>
#include <utility>

#include "engine/base/digest.h"
#include "engine/pipeline/describe_bodies.h"
#include "server/app/extraction_blobs.h"
#include "server/app/extractions.h"
#include "server/app/level_export.h"
#include "server/app/result_streams.h"
#include "server/documents/manifest.h"

// What of an extraction is read as files: parts, whole levels, the bodies. Files that were not there are made first.

namespace geosis::server {
namespace {

Error not_done(const std::string& id, JobState state) {
  return {ErrorCode::already_exists, "extraction " + id + ": it is " + name_of(state) + ", not done"};
}

LevelFile bytes_file(std::vector<std::byte> bytes) {
  LevelFile file{.sha256 = sha256_hex(bytes), .bytes = bytes.size(), .stream = nullptr, .transform = {}};
  file.stream = bytes_stream(std::move(bytes));
  return file;
}

}  // namespace

Result<LevelFile> Extractions::bodies(const std::string& id) {
  const auto extraction = find(id);
  if (!extraction) return extraction.error();
  const Extraction::Snapshot now = (*extraction)->snapshot();
  if (!now.manifest) return not_done(id, now.state);
  auto bytes = store_.get(key(id, kBodies));
  if (!bytes && bytes.error().code == ErrorCode::not_found) {
    if (auto made = make_bodies((*extraction)->identity()); !made) return std::move(made).error();
    bytes = store_.get(key(id, kBodies));
  }
  if (!bytes) return std::move(bytes).error();
  return bytes_file(*std::move(bytes));
}

bool Extractions::are_bodies_made(const std::string& id) {
  const auto made = store_.exists(key(id, kBodies));
  return made && *made;
}

Result<void> Extractions::make_bodies(const Extraction::Identity& identity) {
  return run_and_wait([&](Job& running) -> Result<void> {
    ExtractionTimings unread;
    const auto opened = open(identity, running, unread);
    if (!opened) return opened.error();
    const ExtractionInput input = opened->input();
    const auto bodies = describe_bodies(reconstruct_input(input, opened->options), opened->options, running);
    if (!bodies) return bodies.error();
    return write_document(key(identity.id, kBodies), bodies_document(input.volume, opened->options, *bodies));
  });
}

Result<LevelFile> Extractions::part(const std::string& id, int level, int part) {
  const auto extraction = find(id);
  if (!extraction) return extraction.error();
  auto bytes = (*extraction)->read_part(level, part);
  if (!bytes) {
    if (bytes.error().code != ErrorCode::not_found) return std::move(bytes).error();
    return Error{ErrorCode::not_found,
                 "extraction " + id + ": no part " + std::to_string(part) + " of level " + std::to_string(level)};
  }
  return bytes_file(*std::move(bytes));
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

bool Extractions::is_level_made(const std::string& id, int level, LevelFormat format) {
  const auto made = store_.exists(key(id, level_file_name(level, format) + ".json"));
  if (made && *made) return true;
  const auto more = store_.exists(key(id, part_name(level, 1)));
  return format == LevelFormat::drc && more && !*more;  // one part is the whole level
}

Result<LevelFile> Extractions::level(const std::string& id, int level, LevelFormat format) {
  const auto extraction = find(id);
  if (!extraction) return extraction.error();
  const Extraction::Snapshot now = (*extraction)->snapshot();
  if (!now.manifest) return not_done(id, now.state);
  const Json& levels = now.manifest->at("levels");
  if (level < 0 || level >= static_cast<int>(levels.size())) {
    return Error{ErrorCode::not_found, "extraction " + id + ": no level " + std::to_string(level) + "; it has " +
                                           std::to_string(levels.size())};
  }
  auto file = format == LevelFormat::drc && levels.at(static_cast<std::size_t>(level)).at("parts").size() == 1
                  ? part(id, level, 0)
                  : whole_level(id, level, format, *now.manifest);
  if (file && format == LevelFormat::drc) file->transform = transform_text(now.manifest->at("transform"));
  return file;
}

/// The stored whole file; made first if nobody has asked for it yet.
Result<LevelFile> Extractions::whole_level(const std::string& id, int level, LevelFormat format, const Json& manifest) {
  const std::string name = level_file_name(level, format);
  auto description = read_document(id, (name + ".json").c_str());
  if (!description) {
    if (description.error().code != ErrorCode::not_found) return std::move(description).error();
    if (auto made = make_level_file(id, level, format, manifest); !made) return std::move(made).error();
    description = read_document(id, (name + ".json").c_str());
    if (!description) return std::move(description).error();
  }
  const auto path = store_.local_file(key(id, name));
  if (!path) return path.error();
  auto stream = file_stream(*path);
  if (!stream) return std::move(stream).error();
  return LevelFile{.sha256 = description->at("sha256").get<std::string>(),
                   .bytes = description->at("bytes").get<std::uint64_t>(),
                   .stream = *std::move(stream),
                   .transform = {}};
}

Result<void> Extractions::make_level_file(const std::string& id, int level, LevelFormat format, const Json& manifest) {
  return run_and_wait([&](Job& running) -> Result<void> {
    auto staged = store_.stage();
    if (!staged) return std::move(staged).error();
    auto description = export_level((*staged)->path(), manifest, level, format, part_reader(id), threads_, running);
    if (!description) return std::move(description).error();
    const std::string name = level_file_name(level, format);
    if (auto done = store_.commit(*std::move(staged), key(id, name)); !done) return done;
    return write_document(key(id, name + ".json"), *description);
  });
}

/// On a worker, as all that computes; the caller waits. Two at once make the same file twice, which does no harm.
Result<void> Extractions::run_and_wait(const std::function<Result<void>(Job&)>& work) {
  auto job = queue_.submit(Priority::interactive, work);
  if (!job) return std::move(job).error();
  while (!(*job)->wait_for(std::chrono::hours(1))) {
  }
  const JobStatus status = (*job)->status();
  return status.state == JobState::done ? Result<void>{}
                                        : status.error.value_or(Error{ErrorCode::cancelled, "cancelled"});
}

}  // namespace geosis::server
