// Servers are killed before each system call that their store makes while a volume is uploaded, changed, removed, and
// an extraction computed: afterwards another server finds everything old or new, nothing half, and comes to the same
// end.
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/documents/ids.h"
#include "server/store/dir_store.h"
#include "tests/server/app/service_fixture.h"
#include "tests/server/store/killing_calls.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using geosis::test::End;
using geosis::test::in_own_process;
using geosis::test::KillingCalls;
using test::Service;

constexpr int kMostCalls = 2000;
const Json kOneLevel = {{"range", {0, nullptr}}, {"levels", {{{"ratio", 1}}}}};

/// Threads that an earlier step of this process started would not be there after a fork, so all work is done in
/// processes of its own.
class AppKillCallTest : public testing::Test {
 protected:
  using Step = std::function<bool(Service&, const std::string& volume)>;

  /// For each of its calls, kills `step` there and judges in another process what is left: judge(finished).
  void kill_at_each_call(const Step& prepare, const Step& step, const Step& judge, int stride, int at_least) {
    int killed = 0;
    End end = End::killed;
    for (int number = 0; end == End::killed; number += stride) {
      ASSERT_LT(number, kMostCalls);
      SCOPED_TRACE("killed before call " + std::to_string(number));
      const fs::path root = folder_.path() / std::to_string(number);
      ASSERT_EQ(in_own_process([&] { return with_service(root, system_file_calls(), prepare); }), End::finished);
      end = in_own_process([&] {
        KillingCalls calls(number);
        return with_service(root, calls, step);
      });
      ASSERT_NE(end, End::failed);
      killed += end == End::killed;
      ASSERT_EQ(in_own_process([&] { return with_service(root, system_file_calls(), judge); }), End::finished);
      fs::remove_all(root);
    }
    EXPECT_GT(killed, at_least);
  }

  static bool with_service(const fs::path& root, FileCalls& calls, const Step& step) {
    const auto store = open_dir_store(root, calls);
    if (!store) return false;
    Service service(**store);
    return step(service, volume_id_of_ball());
  }

  static std::string volume_id_of_ball() {
    NoProgress progress;
    const auto bytes = test::ball_file(7);
    const auto imported = import_volume(*memory_source(bytes), test::ball_options().import, std::nullopt, progress);
    return imported ? volume_id(imported->description) : "";
  }

  static bool is_whole(Service& service, const std::string& volume) {
    return service.volumes.document(volume) && service.volumes.slice(volume, SliceAxis::inline_, 10);
  }
  static bool is_absent(Service& service, const std::string& volume) {
    const auto page = service.volumes.list(10, "");
    return page && page->at("volumes").empty() && !service.volumes.open(volume);
  }
  static std::size_t blobs(Service& service) { return service.store.list("", "", 1000)->size(); }

  geosis::test::TemporaryFolder folder_{fs::exists("/dev/shm") ? "/dev/shm" : testing::TempDir()};
};

const auto nothing = [](Service&, const std::string&) { return true; };
const auto upload = [](Service& service, const std::string&) { return !service.add_ball().empty(); };

TEST_F(AppKillCallTest, AnUpload) {
  kill_at_each_call(
      nothing, upload,
      [](Service& service, const std::string& volume) {
        if (!is_whole(service, volume) && !is_absent(service, volume)) return false;
        if (!service.volumes.collect_garbage()) return false;
        if (is_absent(service, volume) && blobs(service) != 0) return false;
        return service.add_ball() == volume && is_whole(service, volume) && blobs(service) == 3;
      },
      1, 40);
}

TEST_F(AppKillCallTest, AChange) {
  kill_at_each_call(
      upload,
      [](Service& service, const std::string& volume) {
        return service.volumes.change(volume, {{"crs", "new"}}).has_value();
      },
      [](Service& service, const std::string& volume) {
        const auto document = service.volumes.document(volume);
        if (!document || !is_whole(service, volume)) return false;
        return document->at("crs").is_null() || document->at("crs") == "new";
      },
      1, 20);
}

TEST_F(AppKillCallTest, ARemoval) {
  kill_at_each_call(
      upload, [](Service& service, const std::string& volume) { return service.volumes.remove(volume).has_value(); },
      [](Service& service, const std::string& volume) {
        if (!is_whole(service, volume) && !is_absent(service, volume)) return false;
        if (is_whole(service, volume) && !service.volumes.remove(volume)) return false;
        return service.volumes.collect_garbage() && is_absent(service, volume) && blobs(service) == 0;
      },
      1, 20);
}

/// The ball's nodes where its samples are, but deeper.
Result<AddedGrid> add_grid(Service& service, const std::string& volume) {
  const auto stored = service.volumes.open(volume);
  if (!stored) return stored.error();
  const GridShape shape = (*stored)->summary.shape;
  std::vector<float> numbers;
  for (int i = 0; i < shape.inlines; ++i)
    for (int j = 0; j < shape.crosslines; ++j)
      for (int k = 0; k < shape.samples; ++k) numbers.insert(numbers.end(), {1.0f * i, 1.0f * j, 100.0f + k});
  NoProgress progress;
  return service.volumes.grids().add((*stored)->summary, *memory_source(std::as_bytes(std::span(numbers))), {},
                                     [] { return Result<void>(); }, progress);
}

std::size_t whole_grids(Service& service, const std::string& volume) {
  const Json page = service.volumes.grids().list(volume, 10, "").value();
  const auto summary = (*service.volumes.open(volume))->summary;
  std::size_t whole = 0;
  for (const Json& grid : page.at("grids")) {
    if (service.volumes.grids().open(summary, grid.at("id").get<std::string>())) ++whole;
  }
  return whole == page.at("grids").size() ? whole : 99;
}

TEST_F(AppKillCallTest, AnUploadOfAGrid) {
  kill_at_each_call(
      upload, [](Service& service, const std::string& volume) { return add_grid(service, volume).has_value(); },
      [](Service& service, const std::string& volume) {
        if (!is_whole(service, volume) || whole_grids(service, volume) > 1) return false;
        if (!service.volumes.collect_garbage()) return false;
        if (blobs(service) != 3 + 2 * whole_grids(service, volume)) return false;
        return add_grid(service, volume) && whole_grids(service, volume) == 1 && blobs(service) == 5;
      },
      1, 10);
}

TEST_F(AppKillCallTest, ARemovalOfAGrid) {
  const auto upload_both = [](Service& service, const std::string&) {
    return add_grid(service, service.add_ball()).has_value();
  };
  const auto remove = [](Service& service, const std::string& volume) {
    const auto ids = service.volumes.grids().list(volume, 10, "");
    return ids && service.volumes.grids().remove(volume, ids->at("grids").at(0).at("id").get<std::string>());
  };
  kill_at_each_call(
      upload_both, remove,
      [&](Service& service, const std::string& volume) {
        if (!is_whole(service, volume) || whole_grids(service, volume) > 1) return false;
        if (whole_grids(service, volume) == 1 && !remove(service, volume)) return false;
        return service.volumes.collect_garbage() && whole_grids(service, volume) == 0 && blobs(service) == 3;
      },
      1, 5);
}

TEST_F(AppKillCallTest, AnExtraction) {
  const auto extract = [](Service& service, const std::string& volume) {
    const auto made = service.extractions.create(volume, kOneLevel, Priority::interactive);
    if (!made) return false;
    (*made)->wait_for(30s);
    return (*made)->snapshot().state == JobState::done;
  };
  kill_at_each_call(
      upload, extract,
      [&](Service& service, const std::string& volume) {
        const auto ids = service.store.children("default/extractions/");
        if (!ids || ids->size() > 1) return false;
        if (!ids->empty()) {  // asked for: what was recorded is computed here, without another POST
          const auto found = service.extractions.find(ids->front());
          if (!found && found.error().code != ErrorCode::not_found) return false;
          if (found) (*found)->wait_for(30s);
          if (found && (*found)->snapshot().state != JobState::done) return false;
          if (found && !service.extractions.part(ids->front(), 0, 0)) return false;
        }
        return extract(service, volume) && service.extractions.purge_results_of(volume) && blobs(service) == 3;
      },
      7, 10);
}

}  // namespace
}  // namespace geosis::server
