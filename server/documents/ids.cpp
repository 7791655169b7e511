#include "server/documents/ids.h"

#include <utility>

#include "engine/base/digest.h"
#include "engine/base/hexadecimal.h"
#include "server/documents/import_options.h"

namespace geosis::server {

bool is_id(const std::string& text) {
  return text.size() == 64 && is_lower_hexadecimal(text);
}

// The first line keeps the two kinds of id apart and leaves room for another recipe.

std::string volume_id(const VolumeDescription& volume) {
  Sha256 digest;
  digest.update("geosis volume 1\n");
  digest.update(volume.digest + "\n");
  digest.update(canonical_text(import_options_document(volume.options)));
  return std::move(digest).hex();
}

std::string extraction_id(std::string_view volume_id, const Json& request, int result_version) {
  Sha256 digest;
  digest.update("geosis extraction 1\n");
  digest.update(std::string(volume_id) + "\n");
  digest.update(std::to_string(result_version) + "\n");
  digest.update(canonical_text(request));
  return std::move(digest).hex();
}

}  // namespace geosis::server
