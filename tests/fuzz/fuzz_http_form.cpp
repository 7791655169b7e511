// Any bytes as a form: read in one piece and in the pieces that the first byte chooses, with the same outcome.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "server/http/wire/form_reader.h"

namespace {

using geosis::Result;

class PiecewiseBody final : public geosis::server::BodyReader {
 public:
  PiecewiseBody(std::string_view bytes, std::size_t piece) : left_(bytes), piece_(piece) {}
  Result<std::size_t> read(std::span<std::byte> into) override {
    const std::size_t count = std::min({into.size(), piece_, left_.size()});
    std::memcpy(into.data(), left_.data(), count);
    left_.remove_prefix(count);
    return count;
  }

 private:
  std::string_view left_;
  std::size_t piece_;
};

/// Everything that was read of the form, or what is wrong with it.
std::string read(std::string_view form, std::size_t piece) {
  PiecewiseBody body(form, piece);
  std::string file;
  const auto fields = geosis::server::http::read_form(body, "b", [&](std::span<const std::byte> bytes) -> Result<void> {
    file.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return {};
  });
  if (!fields) return "refused";
  std::string text = fields->file_name + "\n" + file;
  for (const auto& [name, value] : fields->text) text += "\n" + name + "=" + value;
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view form(reinterpret_cast<const char*>(data + 1), size - 1);
  if (read(form, form.size() + 1) != read(form, std::size_t{data[0]} % 16 + 1)) std::abort();
  return 0;
}
