// A flipped bit in anything that is stored: found, reported, an error of ours, and never sent.
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "server/app/extractions/result_streams.h"
#include "server/store/dir_store.h"
#include "tests/server/app/service_fixture.h"
#include "tests/server/store/temporary_folder.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::Service;

constexpr int kFlips = 3;  // in each file, spread over it

class DamageTest : public testing::Test {
 protected:
  void SetUp() override {
    store->on_damage([this](const BlobKey&, const std::string&) { ++reports; });
    volume = service.add_ball();
    id = (*service.extractions.create(volume, test::ball_request(), Priority::interactive))->identity().id;
    (*service.extractions.find(id))->wait_for(30s);
    std::this_thread::sleep_for(50ms);  // its run record goes
    whole = everything(service);
  }

  /// All that can be asked of the volume and its result; what is refused is the error's code in braces.
  std::vector<std::string> everything(Service& asked) {
    std::vector<std::string> answers;
    const auto add = [&](const auto& result, const auto& text) {
      answers.push_back(result ? text(*result) : std::string("{") + name_of(result.error().code) + "}");
    };
    const auto streamed = [](const LevelFile& file) { return test::read_all(*file.stream); };
    const auto dumped = [](const Json& document) { return document.dump(); };
    add(asked.volumes.document(volume), dumped);
    add(asked.volumes.slice(volume, SliceAxis::sample, 3),
        [](const Slice& slice) { return std::to_string(slice.samples[45]); });
    const auto extraction = asked.extractions.find(id);
    if (extraction) (*extraction)->wait_for(30s);
    add(extraction, [](const auto& found) { return found->snapshot().manifest.value_or(Json()).dump(); });
    for (const LevelFormat format : {LevelFormat::drc, LevelFormat::ply}) {
      add(asked.extractions.level(id, 2, format), streamed);
    }
    add(asked.extractions.bodies(id), streamed);
    return answers;
  }

  /// True when something was refused. What was answered is as it was.
  bool judge(const std::vector<std::string>& answers) const {
    static const std::set<std::string> kRefusals = {"{internal}", "{unavailable}", "{already_exists}", "{not_found}"};
    EXPECT_EQ(answers.size(), whole.size());
    bool has_refused = false;
    for (std::size_t a = 0; a < answers.size(); ++a) {
      if (answers[a] == whole[a]) continue;
      has_refused = true;
      EXPECT_TRUE(kRefusals.contains(answers[a])) << a << ": " << answers[a].substr(0, 200);
    }
    return has_refused;
  }

  static void flip(const fs::path& path, std::uintmax_t at) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(at));
    const int byte = file.get();
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(byte ^ 16));
  }

  std::vector<fs::path> stored_files() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path() / "objects")) {
      if (entry.is_regular_file() && entry.file_size() > 0) files.push_back(entry.path());
    }
    return files;
  }

  geosis::test::TemporaryFolder folder;
  std::unique_ptr<BlobStore> store = std::move(*open_dir_store(folder.path()));
  std::atomic<int> reports{0};
  Service service{*store};
  std::string volume, id;
  std::vector<std::string> whole;
};

TEST_F(DamageTest, IsNeverServedAndOftenMended) {
  std::set<std::string> refused_files;
  for (const fs::path& path : stored_files()) {
    for (int n = 0; n < kFlips; ++n) {
      if (!fs::exists(path)) continue;  // removed as damaged, and not needed again
      SCOPED_TRACE(path.string() + ", flip " + std::to_string(n));
      const fs::path copy = folder.path() / "copy";
      fs::copy_file(path, copy, fs::copy_options::overwrite_existing);
      std::this_thread::sleep_for(5ms);
      flip(path, fs::file_size(path) * static_cast<unsigned>(2 * n + 1) / (2 * kFlips));
      if (judge(everything(service))) refused_files.insert(path.filename());
      {
        Service restarted(*store);  // knows nothing but the store
        if (judge(everything(restarted))) refused_files.insert(path.filename());
      }
      fs::copy_file(copy, path, fs::copy_options::overwrite_existing);
      std::this_thread::sleep_for(5ms);
      for (int again = 0; again < 5 && everything(service) != whole; ++again) {
      }
      EXPECT_EQ(everything(service), whole);
    }
  }
  EXPECT_GT(reports, 20);
  for (const char* name :
       {"volume.json", "sidecar.json", "bricks", "request.json", "manifest.json", "2.0.drc", "2.ply"}) {
    EXPECT_TRUE(refused_files.contains(name)) << name;
  }
}

}  // namespace
}  // namespace geosis::server
