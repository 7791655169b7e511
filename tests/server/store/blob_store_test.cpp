// What every store does, run over each of them.
#include "server/store/blob_store.h"

#include <functional>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "server/store/dir_store.h"
#include "server/store/memory_store.h"
#include "tests/server/store/store_bytes.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

using test::bytes_of;
using test::read_file;
using test::text_of;
using test::write_file;
using Keys = std::vector<BlobKey>;
using Names = std::vector<std::string>;

enum class Kind { directory, memory };

class BlobStoreTest : public testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    auto opened = GetParam() == Kind::directory ? open_dir_store(folder_.path() / "store") : open_memory_store();
    ASSERT_TRUE(opened) << opened.error().message;
    store_ = *std::move(opened);
  }
  void put(const BlobKey& key, std::string_view text = "x") { ASSERT_TRUE(store_->put(key, bytes_of(text))) << key; }
  void put_all(const Keys& keys) {
    for (const auto& key : keys) put(key);
  }
  std::string get(const BlobKey& key) const { return text_of(store_->get(key).value()); }

  test::TemporaryFolder folder_;
  std::unique_ptr<BlobStore> store_;
};

TEST_P(BlobStoreTest, GetReturnsWhatWasPut) {
  const std::string long_text(300'000, 'g');
  put("t/empty", "");
  put("t/a/b/c/d.json", long_text);
  EXPECT_EQ(get("t/empty"), "");
  EXPECT_EQ(get("t/a/b/c/d.json"), long_text);
}

TEST_P(BlobStoreTest, PutReplaces) {
  put("t/a", "first");
  put("t/a", "second, longer");
  EXPECT_EQ(get("t/a"), "second, longer");
}

TEST_P(BlobStoreTest, AConditionalPutNeedsTheVersionThatIsThere) {
  EXPECT_FALSE(store_->put_if("t/a", bytes_of("one"), "some version").value());
  EXPECT_EQ(store_->get_versioned("t/a").error().code, ErrorCode::not_found);
  EXPECT_TRUE(store_->put_if("t/a", bytes_of("one"), "").value());
  EXPECT_FALSE(store_->put_if("t/a", bytes_of("two"), "").value());
  const VersionedBlob first = store_->get_versioned("t/a").value();
  EXPECT_EQ(text_of(first.bytes), "one");
  EXPECT_TRUE(store_->put_if("t/a", bytes_of("two"), first.version).value());
  EXPECT_FALSE(store_->put_if("t/a", bytes_of("three"), first.version).value());
  EXPECT_EQ(get("t/a"), "two");
  ASSERT_TRUE(store_->remove("t/a"));
  EXPECT_FALSE(store_->put_if("t/a", bytes_of("four"), first.version).value());
  EXPECT_FALSE(store_->exists("t/a").value());
}

TEST_P(BlobStoreTest, NoConditionalChangeIsLost) {
  put("t/count", "0");
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([this] {
      for (int added = 0; added < 10;) {
        const VersionedBlob now = store_->get_versioned("t/count").value();
        const std::string next = std::to_string(std::stoi(text_of(now.bytes)) + 1);
        if (store_->put_if("t/count", bytes_of(next), now.version).value()) ++added;
      }
    });
  }
  threads.clear();
  EXPECT_EQ(get("t/count"), "40");
}

TEST_P(BlobStoreTest, TheInventoryTellsSizesAndLastUses) {
  put("t/a", std::string(1000, 'a'));
  put("t/b/c", "c");
  auto blobs = store_->inventory("t/").value();
  ASSERT_EQ(blobs.size(), 2u);
  EXPECT_EQ(blobs[0].key, "t/a");
  EXPECT_GE(blobs[0].bytes, 1000u);
  EXPECT_LT(blobs[0].bytes, 1100u);
  EXPECT_EQ(blobs[1].key, "t/b/c");
  const auto before = blobs[0].used;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  store_->touch("t/a");
  store_->touch("t/none");
  EXPECT_GT(store_->inventory("t/").value()[0].used, before);
  EXPECT_FALSE(store_->exists("t/none").value());
}

TEST_P(BlobStoreTest, ProcessesAreKnownByName) {
  EXPECT_TRUE(store_->may_be_running(store_->process_name()));
  EXPECT_FALSE(store_->may_be_running("process-000000"));
}

TEST_P(BlobStoreTest, AnAbsentBlobIsNotFound) {
  put("t/a/b");
  for (const char* key : {"t/none", "none/x", "t/a", "t/a/b/c"}) {
    EXPECT_EQ(store_->get(key).error().code, ErrorCode::not_found) << key;
    EXPECT_EQ(store_->local_file(key).error().code, ErrorCode::not_found) << key;
    EXPECT_FALSE(store_->exists(key).value()) << key;
  }
  EXPECT_TRUE(store_->exists("t/a/b").value());
}

TEST_P(BlobStoreTest, NamesThatAreNotKeysAreRefused) {
  const std::string long_segment(256, 'a');
  const std::string long_key = std::string(255, 'a') + "/" + std::string(255, 'b') + "/c";
  for (const std::string& key : Keys{"", "/", "/a", "a/", "a//b", ".", "..", "../a", "a/../b", "a/..", "a/./b", "a b",
                                     "a\\b", "a\nb", std::string("a\0b", 3), "\xc3\xa4", long_segment, long_key}) {
    EXPECT_EQ(store_->put(key, {}).error().code, ErrorCode::invalid_argument) << key;
    EXPECT_EQ(store_->get(key).error().code, ErrorCode::invalid_argument) << key;
    EXPECT_EQ(store_->exists(key).error().code, ErrorCode::invalid_argument) << key;
    EXPECT_EQ(store_->remove(key).error().code, ErrorCode::invalid_argument) << key;
    EXPECT_EQ(store_->local_file(key).error().code, ErrorCode::invalid_argument) << key;
    EXPECT_EQ(store_->commit(store_->stage().value(), key).error().code, ErrorCode::invalid_argument) << key;
  }
  EXPECT_TRUE(store_->list("", "", 1).value().empty());
}

TEST_P(BlobStoreTest, TheLongestKeyIsStored) {
  const std::string key = std::string(255, 'a') + "/" + std::string(255, 'b');
  put(key, "long");
  EXPECT_EQ(get(key), "long");
  put("...", "dots");
  EXPECT_EQ(get("..."), "dots");
}

TEST_P(BlobStoreTest, NoKeyIsAFolderOfOthers) {
  put("t/a/b");
  EXPECT_EQ(store_->put("t/a", {}).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(store_->put("t/a/b/c", {}).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(store_->put("t/a/b/c/d", {}).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(store_->list("", "", 10).value(), Keys{"t/a/b"});
}

TEST_P(BlobStoreTest, ListIsSortedByKey) {
  put_all({"t/b", "t/a/z", "t/a.json", "t/a-b/c", "t/a0", "u/a", "t/a/b/c"});
  EXPECT_EQ(store_->list("t/", "", 100).value(), (Keys{"t/a-b/c", "t/a.json", "t/a/b/c", "t/a/z", "t/a0", "t/b"}));
  EXPECT_EQ(store_->list("t/a/", "", 100).value(), (Keys{"t/a/b/c", "t/a/z"}));
  EXPECT_EQ(store_->list("", "", 100).value().size(), 7u);
  EXPECT_TRUE(store_->list("none/", "", 100).value().empty());
  EXPECT_TRUE(store_->list("t/b/", "", 100).value().empty());
}

TEST_P(BlobStoreTest, PagesOfAListJoinToTheList) {
  put_all({"t/b", "t/a/z", "t/a.json", "t/a-b/c", "t/a0", "u/a", "t/a/b/c"});
  const Keys all = store_->list("t/", "", 100).value();
  for (const std::size_t size : {1u, 2u, 4u, 6u}) {
    Keys joined;
    for (Keys page = store_->list("t/", "", size).value(); !page.empty();
         page = store_->list("t/", joined.back(), size).value())
      joined.insert(joined.end(), page.begin(), page.end());
    EXPECT_EQ(joined, all) << size;
  }
  EXPECT_EQ(store_->list("t/", "t/a/c", 1).value(), Keys{"t/a/z"});  // after what is not there
  EXPECT_EQ(store_->list("t/", "a", 1).value(), Keys{"t/a-b/c"});
  EXPECT_TRUE(store_->list("t/", "", 0).value().empty());
  EXPECT_TRUE(store_->list("t/", "u", 9).value().empty());
}

TEST_P(BlobStoreTest, ChildrenAreFilesAndFoldersSortedByName) {
  put_all({"t/b", "t/a/z", "t/a.json", "t/a/b/c", "u/a"});
  EXPECT_EQ(store_->children("t/").value(), (Names{"a", "a.json", "b"}));
  EXPECT_EQ(store_->children("").value(), (Names{"t", "u"}));
  EXPECT_TRUE(store_->children("t/b/").value().empty());
  EXPECT_TRUE(store_->children("none/").value().empty());
}

TEST_P(BlobStoreTest, PrefixesThatStartNoKeysAreRefused) {
  for (const char* prefix : {"t", "/", "t//", "../", "t/../", "t /"}) {
    EXPECT_EQ(store_->list(prefix, "", 1).error().code, ErrorCode::invalid_argument) << prefix;
    EXPECT_EQ(store_->children(prefix).error().code, ErrorCode::invalid_argument) << prefix;
  }
}

TEST_P(BlobStoreTest, RemoveLeavesNoFoldersBehind) {
  put_all({"t/a/b/c", "t/d"});
  ASSERT_TRUE(store_->remove("t/a/b/c"));
  EXPECT_FALSE(store_->exists("t/a/b/c").value());
  EXPECT_EQ(store_->children("t/").value(), Names{"d"});
  put("t/a", "a name that was a folder");
  EXPECT_EQ(get("t/a"), "a name that was a folder");
}

TEST_P(BlobStoreTest, RemovingWhatIsNotThereSucceedsAndRemovesNothing) {
  put("t/a/b");
  for (const char* key : {"t/none", "none/x/y", "t/a", "t/a/b/c"}) EXPECT_TRUE(store_->remove(key)) << key;
  EXPECT_TRUE(store_->exists("t/a/b").value());
}

TEST_P(BlobStoreTest, ACommittedFileIsALocalFile) {
  auto file = store_->stage().value();
  const auto staged = file->path();
  write_file(staged, "bricks");
  EXPECT_TRUE(store_->list("", "", 9).value().empty());
  ASSERT_TRUE(store_->commit(std::move(file), "t/v/bricks"));
  EXPECT_EQ(read_file(store_->local_file("t/v/bricks").value()), "bricks");
  EXPECT_EQ(store_->list("", "", 9).value(), Keys{"t/v/bricks"});
  EXPECT_EQ(store_->get("t/v/bricks").error().code, ErrorCode::internal);
  ASSERT_TRUE(store_->remove("t/v/bricks"));
  EXPECT_FALSE(store_->exists("t/v/bricks").value());
}

TEST_P(BlobStoreTest, AFileThatIsNotCommittedVanishes) {
  auto file = store_->stage().value();
  const auto path = file->path();
  EXPECT_TRUE(std::filesystem::exists(path));
  EXPECT_NE(store_->stage().value()->path(), path);
  file.reset();
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_P(BlobStoreTest, AStagedFileMayBeReplacedByItsWriter) {
  auto file = store_->stage().value();
  const auto path = file->path();
  write_file(path.string() + ".part", "written beside");
  std::filesystem::rename(path.string() + ".part", path);
  ASSERT_TRUE(store_->commit(std::move(file), "t/v"));
  EXPECT_EQ(read_file(store_->local_file("t/v").value()), "written beside");
}

TEST_P(BlobStoreTest, CommitRefusesFilesOfOtherStores) {
  auto other = open_memory_store().value();
  EXPECT_EQ(store_->commit(other->stage().value(), "t/v").error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(store_->commit(nullptr, "t/v").error().code, ErrorCode::invalid_argument);
  EXPECT_FALSE(store_->exists("t/v").value());
}

TEST_P(BlobStoreTest, ThreadsPutAndRemoveInTheSameFolders) {
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([this, t] {
      const std::string key = "t/shared/" + std::to_string(t);
      for (int i = 0; i < 20; ++i) {
        const auto done = store_->put(key, bytes_of(key));
        EXPECT_TRUE(done) << done.error().message;
        EXPECT_EQ(text_of(store_->get(key).value()), key);
        EXPECT_TRUE(store_->remove(key));
      }
    });
  }
  threads.clear();
  EXPECT_TRUE(store_->children("").value().empty());
}

INSTANTIATE_TEST_SUITE_P(Stores, BlobStoreTest, testing::Values(Kind::directory, Kind::memory),
                         [](const auto& store) { return store.param == Kind::directory ? "directory" : "memory"; });

}  // namespace
}  // namespace geosis::server
