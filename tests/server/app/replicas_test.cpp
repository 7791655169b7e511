// Several servers on one store: whoever is asked answers, and what one starts another finishes.
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "server/app/extractions/extractions.h"
#include "server/app/extractions/result_streams.h"
#include "server/app/extractions/run_record.h"
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

constexpr WatchTiming kQuick{.tick = 5ms, .lease = 400ms};

class ReplicasTest : public testing::Test {
 protected:
  std::string create(Service& service) {
    const auto made = service.extractions.create(service.add_ball(), ball_request(), Priority::interactive);
    EXPECT_TRUE(made) << made.error().message;
    return made ? (*made)->identity().id : "";
  }
  static JobState state_of(Service& service, const std::string& id) {
    return (*service.extractions.find(id))->snapshot().state;
  }
  RunRecord record(const std::string& id) const { return *RunRecords(*store, "default").read(id); }

  std::unique_ptr<BlobStore> store = std::move(*open_memory_store());
};

TEST_F(ReplicasTest, WhoDoesNotComputeItSeesItsLevelsAndStreamsThem) {
  Gate gate;
  std::atomic<int> computations{0};
  Service first(*store, gated_after(3, gate), 2, kQuick);
  Service second(
      *store, [&](auto&&... arguments) { return computations++, reconstruct(arguments...); }, 2, kQuick);
  const std::string id = create(first);
  const auto seen = *second.extractions.find(id);
  EXPECT_TRUE(comes_true([&] { return seen->snapshot().levels.size() == 2; }));
  EXPECT_EQ(seen->snapshot().state, JobState::running);
  EXPECT_TRUE(second.extractions.part(id, 4, 0));
  std::string streamed;
  std::jthread reader([&] { streamed = test::read_all(*level_stream(seen, "edge", {})); });
  gate.open();
  reader.join();
  EXPECT_TRUE(streamed.ends_with("--edge--\r\n"));
  EXPECT_EQ(streamed, test::read_all(*level_stream(*first.extractions.find(id), "edge", {})));
  EXPECT_EQ(computations, 0);
  EXPECT_TRUE(comes_true([&] { return !store->exists("default/extractions/" + id + "/run.json").value(); }));
}

TEST_F(ReplicasTest, EqualRequestsToTwoServersAreComputedOnce) {
  std::atomic<int> computations{0};
  const ReconstructFunction counted = [&](auto&&... arguments) { return computations++, reconstruct(arguments...); };
  Service first(*store, counted, 2, kQuick), second(*store, counted, 2, kQuick);
  const std::string volume = first.add_ball();
  {
    std::vector<std::jthread> clients;
    for (int n = 0; n < 10; ++n) {
      clients.emplace_back([&, n] {
        const auto made = (n % 2 ? first : second).extractions.create(volume, ball_request(), Priority::interactive);
        ASSERT_TRUE(made) << made.error().message;
        (*made)->wait_for(30s);
        EXPECT_EQ((*made)->snapshot().state, JobState::done);
      });
    }
  }
  EXPECT_EQ(computations, 1);
}

TEST_F(ReplicasTest, AnOwnerThatStandsStillLosesItsLeaseAndDoesNoHarm) {
  Gate gate;
  std::string id;
  Service first(*store, gated_after(4, gate), 2, {.tick = 1500ms, .lease = 200ms});  // slow to renew
  Service second(*store, reconstruct, 2, kQuick);
  id = create(first);
  ASSERT_TRUE(comes_true([&] { return gate.has_arrived(); }));
  const auto taken = *second.extractions.find(id);
  taken->wait_for(30s);
  EXPECT_EQ(taken->snapshot().state, JobState::done);
  gate.open();
  const auto late = *first.extractions.find(id);
  late->wait_for_work(30s);
  EXPECT_TRUE(comes_true([&] { return state_of(first, id) == JobState::done; }));
  EXPECT_EQ(state_of(second, id), JobState::done);
  EXPECT_EQ(second.extractions.level(id, 0, LevelFormat::drc)->bytes,
            first.extractions.level(id, 0, LevelFormat::drc)->bytes);
}

TEST_F(ReplicasTest, InterestIsCountedOverAllServersAndTheLastWithdrawalStopsTheWork) {
  Gate gate;
  Service first(*store, gated_after(4, gate), 2, kQuick), second(*store, reconstruct, 2, kQuick);
  const std::string id = create(first);
  ASSERT_TRUE(comes_true([&] { return gate.has_arrived(); }));
  EXPECT_EQ(create(second), id);
  EXPECT_EQ(record(id).interest, 2);
  ASSERT_TRUE(second.extractions.withdraw(id));
  EXPECT_EQ(state_of(first, id), JobState::running);
  ASSERT_TRUE(second.extractions.withdraw(id));
  EXPECT_EQ(record(id).state, RunRecord::State::cancelled);  // durable when it is acknowledged
  EXPECT_TRUE(comes_true([&] { return state_of(first, id) == JobState::cancelled; }));
  EXPECT_TRUE(comes_true([&] { return state_of(second, id) == JobState::cancelled; }));
  gate.open();
  EXPECT_EQ(create(second), id);
  EXPECT_TRUE(comes_true([&] { return state_of(first, id) == JobState::done; }));
}

TEST_F(ReplicasTest, AFailureIsToldByEveryServerUntilItIsAskedForAgain) {
  std::atomic<bool> fails{true};
  Service first(
      *store,
      [&](auto&&... arguments) -> Result<Reconstruction> {
        if (fails) return Error{ErrorCode::limit_exceeded, "out of luck"};
        return reconstruct(arguments...);
      },
      2, kQuick);
  Service second(*store, reconstruct, 2, kQuick);
  const std::string id = create(first);
  EXPECT_TRUE(comes_true([&] { return state_of(second, id) == JobState::failed; }));
  const auto error = (*second.extractions.find(id))->snapshot().error;
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::limit_exceeded);
  EXPECT_EQ(error->message, "out of luck");
  fails = false;
  create(second);
  EXPECT_TRUE(comes_true([&] { return state_of(first, id) == JobState::done; }));
}

TEST_F(ReplicasTest, RemovedByOneServerWhileAnotherComputesItLeavesNothing) {
  Gate gate;
  Service first(*store, gated_after(4, gate), 2, kQuick), second(*store, reconstruct, 2, kQuick);
  const std::string id = create(first);
  ASSERT_TRUE(comes_true([&] { return gate.has_arrived(); }));
  ASSERT_TRUE(second.extractions.purge(id));
  EXPECT_EQ(second.extractions.find(id).error().code, ErrorCode::not_found);
  gate.open();
  EXPECT_TRUE(comes_true([&] { return !first.extractions.find(id); }));
  EXPECT_TRUE(comes_true([&] { return store->list("default/extractions/", "", 10)->empty(); }));
}

TEST_F(ReplicasTest, RemovedByOneServerIsGoneAtTheOtherThatHadIt) {
  Service first(*store, reconstruct, 2, kQuick), second(*store, reconstruct, 2, kQuick);
  const std::string id = create(first);
  (*first.extractions.find(id))->wait_for(30s);
  ASSERT_TRUE(second.extractions.purge(id));
  EXPECT_EQ(first.extractions.find(id).error().code, ErrorCode::not_found);
}

TEST_F(ReplicasTest, AResultWithAMissingPartIsComputedAgain) {
  Service first(*store, reconstruct, 2, kQuick);
  const std::string id = create(first);
  (*first.extractions.find(id))->wait_for(30s);
  const std::string before = test::read_all(*first.extractions.part(id, 2, 0)->stream);
  ASSERT_TRUE(store->remove("default/extractions/" + id + "/parts/2.0.drc"));
  EXPECT_EQ(first.extractions.part(id, 2, 0).error().code, ErrorCode::unavailable);
  EXPECT_EQ(first.extractions.part(id, 2, 7).error().code, ErrorCode::not_found);  // there never was one
  (*first.extractions.find(id))->wait_for(30s);
  EXPECT_EQ(test::read_all(*first.extractions.part(id, 2, 0)->stream), before);
}

TEST_F(ReplicasTest, WhatIsLeftWithoutRequestOrVolumeIsCollected) {
  Service service(*store, reconstruct, 2, kQuick);
  const std::string id = create(service), volume = (*service.extractions.find(id))->identity().volume;
  (*service.extractions.find(id))->wait_for_work(30s);  // its lease is gone then
  const std::size_t whole = store->list("default/", "", 1000)->size();
  const std::string left = "default/extractions/" + std::string(64, 'e');
  ASSERT_TRUE(store->put(left + "/parts/0.0.drc", {}));
  ASSERT_TRUE(service.extractions.collect_garbage());
  EXPECT_EQ(store->list("default/", "", 1000)->size(), whole);
  ASSERT_TRUE(service.volumes.remove(volume));  // and not what was derived from it
  ASSERT_TRUE(service.extractions.collect_garbage());
  EXPECT_TRUE(store->list("default/", "", 1000)->empty());
}

TEST_F(ReplicasTest, ARecordThatIsDamagedIsTakenForNone) {
  RunRecords records(*store, "default");
  ASSERT_TRUE(store->put("default/extractions/x/run.json", {}));
  EXPECT_EQ(records.read("x")->owner, "");
  const auto updated = records.update("x", [](RunRecord& record) { return ++record.interest, true; });
  ASSERT_TRUE(updated);
  EXPECT_EQ(records.read("x")->interest, 1);
}

}  // namespace
}  // namespace geosis::server
