#include "engine/core/sha256.h"

#include <gtest/gtest.h>

#include "engine/core/check.h"

namespace ed3r {
namespace {

std::string HexOf(std::string_view text) {
  Sha256 sha;
  sha.Update(text);
  return sha.Hex();
}

// Known answers of FIPS 180-4.
TEST(Sha256Test, KnownAnswers) {
  EXPECT_EQ(HexOf(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(HexOf("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(HexOf(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256Test, PiecesMakeTheWhole) {
  Sha256 sha;
  for (char letter : std::string("abc")) sha.Update(&letter, 1);
  EXPECT_EQ(sha.Hex(), HexOf("abc"));
  EXPECT_THROW(sha.Update("more"), InternalError);
  EXPECT_THROW(sha.Hex(), InternalError);
}

}  // namespace
}  // namespace ed3r
