// What an earlier report has left in a folder.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace ed3r::report {

// Takes away what `ed3r report` may have written to this folder, index.html first, and nothing else: manifest.json alone
// stays, by which the folder is known as a report's. Of pictures those go that figures/data.json lists, of missions/ the pages whose title
// is their name. Throws UserError where a file cannot be taken away.
void RemoveOldReport(const std::filesystem::path& folder);

// Pictures of these figures ([{"id"}]) in `folder`, of which nothing need be right.
void RemovePictures(const std::filesystem::path& folder, const nlohmann::ordered_json& figures);

}  // namespace ed3r::report
