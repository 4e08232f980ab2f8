// Data files that a library carries in itself (hyselam_embed_texts() in CMake makes the header).
#pragma once

namespace hyselam {

struct EmbeddedText {
  const char* key;   ///< e.g. the language of a grammar
  const char* text;  ///< the whole file
};

}  // namespace hyselam
