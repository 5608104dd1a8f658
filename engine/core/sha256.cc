#include "engine/core/sha256.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include "engine/core/check.h"

namespace ed3r {

void Sha256::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  ED3R_CHECK(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1, "OpenSSL SHA-256");
}

void Sha256::Update(const void* data, std::size_t bytes) {
  ED3R_CHECK(context_, "finished before");
  ED3R_CHECK(EVP_DigestUpdate(context_.get(), data, bytes) == 1, "OpenSSL SHA-256");
}

std::string Sha256::Hex() {
  ED3R_CHECK(context_, "finished before");
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  ED3R_CHECK(EVP_DigestFinal_ex(context_.get(), digest, &size) == 1, "OpenSSL SHA-256");
  context_.reset();
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

}  // namespace ed3r
