#include "server/app/extractions/run_record.h"

#include <array>
#include <span>
#include <utility>

namespace geosis::server {
namespace {

/// How often another process may come first between looking and changing. Each time takes the right moment.
constexpr int kMaxAttempts = 1000;

constexpr std::array kStates = {std::pair{RunRecord::State::wanted, "wanted"},
                                std::pair{RunRecord::State::cancelled, "cancelled"},
                                std::pair{RunRecord::State::failed, "failed"}};

Json error_document(const std::optional<Error>& error) {
  if (!error) return nullptr;
  return {{"code", name_of(error->code)}, {"message", error->message}};
}

std::optional<Error> parse_error(const Json& document) {
  if (document.is_null()) return std::nullopt;
  Error error{ErrorCode::internal, document.at("message").get<std::string>()};
  const std::string code = document.at("code").get<std::string>();
  for (int value = 0; value <= static_cast<int>(ErrorCode::internal); ++value) {
    if (code == name_of(static_cast<ErrorCode>(value))) error.code = static_cast<ErrorCode>(value);
  }
  return error;
}

Json document_of(const RunRecord& record) {
  const char* state = "wanted";
  for (const auto& [value, name] : kStates) {
    if (value == record.state) state = name;
  }
  return {{"state", state},        {"interest", record.interest}, {"owner", record.owner},
          {"beat", record.beat},   {"lease_ms", record.lease_ms}, {"levels", record.levels},
          {"stage", record.stage}, {"progress", record.progress}, {"error", error_document(record.error)}};
}

Result<RunRecord> parse_record(std::span<const std::byte> bytes) {
  const auto document = parse_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!document) return document.error();
  try {
    RunRecord record;
    for (const auto& [value, name] : kStates) {
      if (document->at("state") == name) record.state = value;
    }
    record.interest = document->at("interest").get<int>();
    record.owner = document->at("owner").get<std::string>();
    record.beat = document->at("beat").get<std::uint64_t>();
    record.lease_ms = document->at("lease_ms").get<std::int64_t>();
    record.levels = document->at("levels").get<std::size_t>();
    record.stage = document->at("stage").get<std::string>();
    record.progress = document->at("progress").get<double>();
    record.error = parse_error(document->at("error"));
    return record;
  } catch (const Json::exception& problem) {
    return Error{ErrorCode::malformed_input, std::string("run record: ") + problem.what()};
  }
}

}  // namespace

Result<RunRecords::Seen> RunRecords::look(const std::string& id) const {
  const auto stored = store_.get_versioned(key(id));
  if (!stored && stored.error().code == ErrorCode::not_found) return Seen{};
  if (!stored && stored.error().code != ErrorCode::internal) return stored.error();
  if (stored) {
    if (auto record = parse_record(stored->bytes)) return Seen{*std::move(record), stored->version};
    store_.report_damage(key(id), "it is no run record");
  }
  if (auto removed = store_.remove(key(id)); !removed) return std::move(removed).error();
  return Seen{};
}

Result<RunRecord> RunRecords::read(const std::string& id) const {
  auto seen = look(id);
  if (!seen) return std::move(seen).error();
  return std::move(seen->record);
}

Result<RunRecord> RunRecords::update(const std::string& id, const std::function<bool(RunRecord&)>& change) {
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    auto seen = look(id);
    if (!seen) return std::move(seen).error();
    if (!change(seen->record)) return std::move(seen->record);
    const std::string text = document_text(document_of(seen->record));
    const auto done = store_.put_if(key(id), std::as_bytes(std::span(text)), seen->version);
    if (!done) return done.error();
    if (*done) return std::move(seen->record);
  }
  return Error{ErrorCode::unavailable, "extraction " + id + ": too many changes at one time"};
}

}  // namespace geosis::server
