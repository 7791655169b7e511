#include "server/http/uploads/upload_threads.h"

#include <latch>

#include <gtest/gtest.h>

namespace geosis::server::http {
namespace {

TEST(UploadThreads, KeepAQuarterForOtherPeers) {
  Slots slots(8);
  UploadThreads uploads(slots);
  std::latch end(1);
  const auto upload = [&] { end.wait(); };
  std::uint64_t connection = 0;
  while (uploads.start(connection, "10.0.0.1", upload)) ++connection;
  EXPECT_EQ(connection, 6u);
  EXPECT_FALSE(uploads.has_room("10.0.0.1"));
  EXPECT_TRUE(uploads.start(connection++, "10.0.0.2", upload));
  EXPECT_TRUE(uploads.start(connection++, "10.0.0.3", upload));
  EXPECT_FALSE(uploads.has_room("10.0.0.4"));
  end.count_down();
  uploads.finished(0);
  EXPECT_TRUE(uploads.has_room("10.0.0.1"));
}

TEST(UploadThreads, GiveTheOnlyOneToAnybody) {
  Slots slots(1);
  UploadThreads uploads(slots);
  EXPECT_TRUE(uploads.start(0, "10.0.0.1", [] {}));
  EXPECT_FALSE(uploads.has_room("10.0.0.2"));
  uploads.finished(0);
  EXPECT_TRUE(uploads.has_room("10.0.0.2"));
}

}  // namespace
}  // namespace geosis::server::http
