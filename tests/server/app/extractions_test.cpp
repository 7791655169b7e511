#include "server/app/extractions/extractions.h"

#include <atomic>
#include <latch>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "server/app/extractions/result_streams.h"
#include "server/store/memory_store.h"
#include "tests/server/app/service_fixture.h"

namespace geosis::server {
namespace {

using namespace std::chrono_literals;
using test::ball_request;
using test::comes_true;
using test::Gate;
using test::gated_after;
using test::Service;

class ExtractionsTest : public testing::Test {
 protected:
  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
};

TEST_F(ExtractionsTest, ComesToAManifestWithAllParts) {
  Service service(*store);
  const auto extraction = service.extractions.create(service.add_ball(), ball_request(), Priority::interactive);
  ASSERT_TRUE(extraction) << extraction.error().message;
  (*extraction)->wait_for(30s);
  const auto now = (*extraction)->snapshot();
  ASSERT_EQ(now.state, JobState::done);
  ASSERT_EQ(now.manifest->at("levels").size(), 5u);
  EXPECT_EQ(now.manifest->at("id"), (*extraction)->identity().id);
  for (const Json& level : now.manifest->at("levels")) {
    EXPECT_EQ(level.at("euler"), 2);
    EXPECT_TRUE((*extraction)->read_part(level.at("level"), 0));
  }
}

TEST_F(ExtractionsTest, FiftyEqualRequestsAreComputedOnce) {
  std::atomic<int> computations{0};
  Service service(*store, [&](auto&&... arguments) { return computations++, reconstruct(arguments...); });
  const std::string volume = service.add_ball();
  std::mutex mutex;
  std::set<std::string> manifests;
  std::latch start(50);
  {
    std::vector<std::jthread> clients;
    for (int n = 0; n < 50; ++n) {
      clients.emplace_back([&] {
        start.arrive_and_wait();
        const auto extraction = service.extractions.create(volume, ball_request(), Priority::interactive);
        ASSERT_TRUE(extraction) << extraction.error().message;
        (*extraction)->wait_for(30s);
        const auto manifest = (*extraction)->snapshot().manifest;
        const std::lock_guard lock(mutex);
        manifests.insert(manifest ? manifest->dump() : "none");
      });
    }
  }
  EXPECT_EQ(computations, 1);
  EXPECT_EQ(manifests.size(), 1u);
  EXPECT_FALSE(manifests.contains("none"));
}

TEST_F(ExtractionsTest, CoarsestLevelIsReadableWhileTheFinestIsNotEncoded) {
  Gate gate;
  Service service(*store, gated_after(4, gate));
  const auto extraction = service.extractions.create(service.add_ball(), ball_request(), Priority::interactive);
  ASSERT_TRUE(extraction);
  ASSERT_TRUE(comes_true([&] { return gate.has_arrived(); }));
  const auto now = (*extraction)->snapshot();
  EXPECT_EQ(now.state, JobState::running);
  ASSERT_EQ(now.levels.size(), 1u);
  EXPECT_EQ(now.levels[0].at("level"), 4);
  EXPECT_TRUE(service.extractions.part((*extraction)->identity().id, 4, 0));
  EXPECT_EQ(service.extractions.level((*extraction)->identity().id, 4, LevelFormat::drc).error().code,
            ErrorCode::already_exists);
  const auto stream = level_stream(*extraction, "edge", {});
  std::string left;
  std::byte piece[1000];
  for (;;) {
    const auto pulled = stream->pull(piece);
    ASSERT_TRUE(pulled);
    if (pulled->state != ByteStream::Pulled::State::data) break;
    left.append(reinterpret_cast<const char*>(piece), pulled->count);
  }
  EXPECT_NE(left.find("X-Geosis-Level: 4"), std::string::npos);
  EXPECT_EQ(left.find("X-Geosis-Level: 3"), std::string::npos);
  gate.open();
  (*extraction)->wait_for(30s);
  EXPECT_EQ((*extraction)->snapshot().state, JobState::done);
}

TEST_F(ExtractionsTest, StopsWhenTheLastInterestIsWithdrawn) {
  Gate gate;
  Service service(*store, gated_after(4, gate));
  const std::string volume = service.add_ball();
  const auto first = service.extractions.create(volume, ball_request(), Priority::interactive);
  const auto second = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(first && second);
  const std::string id = (*first)->identity().id;
  ASSERT_TRUE(comes_true([&] { return gate.has_arrived(); }));
  ASSERT_TRUE(service.extractions.withdraw(id));
  EXPECT_EQ((*first)->snapshot().state, JobState::running);
  const auto withdrawn = std::chrono::steady_clock::now();
  ASSERT_TRUE(service.extractions.withdraw(id));
  (*first)->wait_for(30s);
  EXPECT_LT(std::chrono::steady_clock::now() - withdrawn, 5s);
  EXPECT_EQ((*first)->snapshot().state, JobState::cancelled);

  Service restarted(*store);  // the cancellation outlives the process
  EXPECT_EQ((*restarted.extractions.find(id))->snapshot().state, JobState::cancelled);
  const auto again = restarted.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(again);
  (*again)->wait_for(30s);
  EXPECT_EQ((*again)->snapshot().state, JobState::done);
}

TEST_F(ExtractionsTest, AskedForAgainWhileItStopsItStartsAnew) {
  std::atomic<int> runs{0};
  std::atomic<bool> may_end{false};
  Service service(*store, [&](auto&&... arguments) -> Result<Reconstruction> {
    if (runs++ > 0) return reconstruct(arguments...);
    while (!may_end) std::this_thread::sleep_for(1ms);  // slow to notice that nobody wants it
    return Error{ErrorCode::cancelled, "stopped"};
  });
  const std::string volume = service.add_ball();
  const auto first = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(first);
  ASSERT_TRUE(comes_true([&] { return runs > 0; }));
  ASSERT_TRUE(service.extractions.withdraw((*first)->identity().id));
  const auto second = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(second);
  may_end = true;
  (*second)->wait_for(30s);
  EXPECT_EQ((*second)->snapshot().state, JobState::done);
}

TEST_F(ExtractionsTest, RefusedForAFullQueueLeavesNothing) {
  Service service(*store);
  const std::string volume = service.add_ball();
  service.queue.stop();  // takes nothing any more
  const auto refused = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::unavailable);
  EXPECT_TRUE(store->list("default/extractions/", "", 10)->empty());
  EXPECT_TRUE(store->list("default/volumes/" + volume + "/results/", "", 10)->empty());
}

TEST_F(ExtractionsTest, ReaderWhoLeavesEndsOnlyWhatHeReads) {
  Gate gate;
  Service service(*store, gated_after(4, gate));
  const std::string volume = service.add_ball();
  const auto first = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(first);
  ASSERT_TRUE(comes_true([&] { return gate.has_arrived(); }));
  ASSERT_TRUE(service.extractions.withdraw((*first)->identity().id));
  const auto second = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(second);
  (*first)->abandon();  // the stream of the one that was stopped breaks only now
  gate.open();
  (*second)->wait_for(30s);
  EXPECT_EQ((*second)->snapshot().state, JobState::done);
}

TEST_F(ExtractionsTest, PurgedWhileItRunsLeavesNothing) {
  Gate gate;
  Service service(*store, gated_after(4, gate));
  const auto running = service.extractions.create(service.add_ball(), ball_request(), Priority::interactive);
  ASSERT_TRUE(running);
  ASSERT_TRUE(comes_true([&] { return gate.has_arrived(); }));
  ASSERT_TRUE(service.extractions.purge((*running)->identity().id));
  EXPECT_TRUE(store->list("default/extractions/", "", 10)->empty());
}

TEST_F(ExtractionsTest, FailedOneStartsAgain) {
  std::atomic<bool> fails{true};
  Service service(*store, [&](auto&&... arguments) -> Result<Reconstruction> {
    if (fails) return Error{ErrorCode::internal, "out of luck"};
    return reconstruct(arguments...);
  });
  const std::string volume = service.add_ball();
  const auto failed = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(failed);
  (*failed)->wait_for(30s);
  EXPECT_EQ((*failed)->snapshot().state, JobState::failed);
  EXPECT_EQ(resource_document(**failed).at("error").at("detail"), "out of luck");
  fails = false;
  const auto again = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(again);
  (*again)->wait_for(30s);
  EXPECT_EQ((*again)->snapshot().state, JobState::done);
}

TEST_F(ExtractionsTest, AnotherServerOnTheStoreAnswersForTheId) {
  Service first(*store), second(*store);
  const auto made = first.extractions.create(first.add_ball(), ball_request(), Priority::interactive);
  ASSERT_TRUE(made);
  (*made)->wait_for(30s);
  const auto found = second.extractions.find((*made)->identity().id);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ((*found)->snapshot().manifest, (*made)->snapshot().manifest);
  EXPECT_TRUE((*found)->read_part(0, 0));
}

TEST_F(ExtractionsTest, RecordedRequestIsComputedAfterARestart) {
  std::string id;
  {
    Gate never;
    Service dying(*store, gated_after(4, never));
    const auto started = dying.extractions.create(dying.add_ball(), ball_request(), Priority::interactive);
    ASSERT_TRUE(started);
    id = (*started)->identity().id;
    ASSERT_TRUE(comes_true([&] { return never.has_arrived(); }));
  }  // stops in the middle, without anybody having cancelled it
  Service restarted(*store);
  const auto found = restarted.extractions.find(id);
  ASSERT_TRUE(found);
  (*found)->wait_for(30s);
  EXPECT_EQ((*found)->snapshot().state, JobState::done);
}

TEST_F(ExtractionsTest, NothingInRangeIsDoneAndEmpty) {
  Service service(*store);
  const auto extraction =
      service.extractions.create(service.add_ball(), {{"range", {100, nullptr}}}, Priority::interactive);
  ASSERT_TRUE(extraction);
  (*extraction)->wait_for(30s);
  const auto manifest = (*extraction)->snapshot().manifest;
  ASSERT_TRUE(manifest);
  EXPECT_EQ(manifest->at("empty"), true);
  EXPECT_EQ(service.extractions.level((*extraction)->identity().id, 0, LevelFormat::drc).error().code,
            ErrorCode::not_found);
}

TEST_F(ExtractionsTest, WhyItIsEmptyIsKept) {
  std::string id;
  {
    Service service(*store);
    const auto extraction = service.extractions.create(
        service.add_ball(), {{"range", {0, nullptr}}, {"bodies", {{"seeds", {{0, 0, 0}}}}}}, Priority::interactive);
    ASSERT_TRUE(extraction);
    (*extraction)->wait_for(30s);
    id = (*extraction)->identity().id;
    const Json document = resource_document(**extraction);
    EXPECT_EQ(document.at("empty"), true);
    EXPECT_EQ(document.at("empty_because"), Json({{"code", "no_seeded_body"}, {"detail", "No body contains a seed."}}));
  }
  Service restarted(*store);
  const auto found = restarted.extractions.find(id);
  ASSERT_TRUE(found);
  EXPECT_EQ(resource_document(**found).at("empty_because").at("code"), "no_seeded_body");
}

TEST_F(ExtractionsTest, TransientOneKnowsNoStoredGrid) {
  Service service(*store);
  const auto bytes = test::ball_file(6);
  NoProgress progress;
  std::vector<GridCandidate> candidates;
  for (const auto& [grid, code] : {std::pair{std::string(64, '0'), ErrorCode::unsupported},
                                   std::pair{std::string("foo"), ErrorCode::invalid_argument}}) {
    const auto refused = service.extractions.create_transient(
        *memory_source(bytes), test::ball_options(), {{"range", {0, nullptr}}, {"grid", grid}}, progress, candidates);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, code);
    EXPECT_EQ(
        refused.error().message,
        "request /grid: \"" + grid + "\"; expected given, structural or auto: a one-shot call has no stored grids");
  }
}

TEST_F(ExtractionsTest, TransientOneKeepsNothing) {
  Service service(*store);
  const auto bytes = test::ball_file(6);
  NoProgress progress;
  std::vector<GridCandidate> candidates;
  const auto extraction = service.extractions.create_transient(*memory_source(bytes), test::ball_options(),
                                                               ball_request(), progress, candidates);
  ASSERT_TRUE(extraction) << extraction.error().message;
  const std::string answer = test::read_all(*level_stream(*extraction, "edge", {}));
  EXPECT_TRUE(answer.ends_with("--edge--\r\n"));
  EXPECT_TRUE(store->list("default/", "", 10)->empty());
}

TEST_F(ExtractionsTest, PurgeRemovesAllOfIt) {
  Service service(*store);
  const std::string volume = service.add_ball();
  const auto extraction = service.extractions.create(volume, ball_request(), Priority::interactive);
  ASSERT_TRUE(extraction);
  (*extraction)->wait_for(30s);
  const std::string id = (*extraction)->identity().id;
  ASSERT_TRUE(service.extractions.purge_results_of(volume));
  EXPECT_EQ(service.extractions.find(id).error().code, ErrorCode::not_found);
  EXPECT_TRUE(store->list("default/extractions/", "", 10)->empty());
}

TEST_F(ExtractionsTest, RefusesWhatCannotBe) {
  Service service(*store);
  const std::string volume = service.add_ball();
  EXPECT_EQ(service.extractions.create(std::string(64, 'a'), ball_request(), Priority::interactive).error().code,
            ErrorCode::not_found);
  EXPECT_EQ(service.extractions.create(volume, Json::object(), Priority::interactive).error().code,
            ErrorCode::invalid_argument);
  const Json outside = {{"range", {0, nullptr}},
                        {"region", {{"inline", {0, 20}}, {"crossline", {0, 19}}, {"sample", {0, 19}}}}};
  const auto refused = service.extractions.create(volume, outside, Priority::interactive);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  EXPECT_TRUE(refused.error().message.starts_with("request /region/inline: ")) << refused.error().message;
  EXPECT_TRUE(store->list("default/extractions/", "", 10)->empty());
  EXPECT_EQ(service.extractions.find(std::string(64, 'b')).error().code, ErrorCode::not_found);
  EXPECT_EQ(service.extractions.find("../x").error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace geosis::server
