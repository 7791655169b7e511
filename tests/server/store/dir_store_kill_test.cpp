// A process that stores blobs is killed at random moments: what it had acknowledged is there, the rest is whole or
// absent.
#include <chrono>
#include <iterator>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/store/dir_store.h"
#include "tests/server/store/store_bytes.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::read_file;
using test::text_of;
using test::write_file;

constexpr int kRounds = 12;

// Every third one is a committed file, the others are put.
bool is_file(int number) {
  return number % 3 == 0;
}

std::string key_of(int round, int number) {
  return "t/round" + std::to_string(round) + "/" + std::to_string(number % 5) + "/" + std::to_string(number);
}

std::string content_of(int number) {
  return std::string(1 + (number * 7919) % 60'000, static_cast<char>('a' + number % 26));
}

Result<void> store_one(BlobStore& store, const BlobKey& key, int number) {
  if (!is_file(number)) return store.put(key, bytes_of(content_of(number)));
  auto file = store.stage();
  if (!file) return file.error();
  write_file((*file)->path(), content_of(number));
  return store.commit(*std::move(file), key);
}

// Stores blobs and writes a byte for each that is acknowledged, until it is killed.
[[noreturn]] void run_child(const fs::path& root, int round, int acknowledge) {
  const auto store = open_dir_store(root);
  if (!store) _exit(1);
  for (int number = 0;; ++number) {
    if (!store_one(**store, key_of(round, number), number)) _exit(2);
    if (write(acknowledge, "+", 1) != 1) _exit(3);
  }
}

// Returns how many blobs the killed child had acknowledged.
int run_and_kill(const fs::path& root, int round, std::chrono::microseconds life) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) run_child(root, round, ends[1]);
  close(ends[1]);
  char byte = 0;
  int acknowledged = read(ends[0], &byte, 1) == 1 ? 1 : 0;  // at work
  std::this_thread::sleep_for(life);
  EXPECT_EQ(kill(child, SIGKILL), 0);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status)) << "exit status " << WEXITSTATUS(status);
  while (read(ends[0], &byte, 1) == 1) ++acknowledged;
  close(ends[0]);
  return acknowledged;
}

std::string stored_content(const BlobStore& store, const BlobKey& key, int number) {
  if (is_file(number)) return read_file(store.local_file(key).value());
  const auto got = store.get(key);
  return got ? text_of(*got) : got.error().message;
}

TEST(DirStoreKill, AcknowledgedBlobsAreWholeAndNothingHalfIsVisible) {
  const test::TemporaryFolder folder;
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < kRounds; ++round) {
    const int acknowledged = run_and_kill(folder.path(), round, std::chrono::microseconds(random() % 60'000));
    EXPECT_GT(acknowledged, 0);
    const auto store = open_dir_store(folder.path()).value();
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path() / "staging"), {}), 1);  // this process's own
    for (int number = 0; number < acknowledged; ++number)
      EXPECT_TRUE(store->exists(key_of(round, number)).value()) << number << " of " << acknowledged;
    const auto keys = store->list("t/round" + std::to_string(round) + "/", "", 100'000).value();
    EXPECT_LE(keys.size(), static_cast<std::size_t>(acknowledged) + 1);
    for (const auto& key : keys) {
      const int number = std::stoi(key.substr(key.rfind('/') + 1));
      EXPECT_EQ(stored_content(*store, key, number), content_of(number)) << key;
    }
  }
}

}  // namespace
}  // namespace geosis::server
