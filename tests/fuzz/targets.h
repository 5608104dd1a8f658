// What is fuzzed: one function for each kind of file that somebody else may have written. Whatever the bytes, a reader
// returns or throws UserError; anything else ends the process and is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace ed3r {

using FuzzFunction = void (*)(std::string_view bytes);

void FuzzSweep(std::string_view bytes);
void FuzzWorld(std::string_view bytes);
void FuzzGrid(std::string_view bytes);
void FuzzStemMap(std::string_view bytes);
// Whatever the content says it is: CSV, AirData, ULog, DataFlash.
void FuzzLog(std::string_view bytes);
void FuzzLogFormat(std::string_view bytes);
void FuzzNpy(std::string_view bytes);
void FuzzPicture(std::string_view bytes);
void FuzzOnnx(std::string_view bytes);
void FuzzNetwork(std::string_view bytes);
// The payload of each: what whoever seals a file himself may put into it.
void FuzzModel(std::string_view bytes);
void FuzzWeights(std::string_view bytes);
void FuzzCheckpoint(std::string_view bytes);
void FuzzAirframe(std::string_view bytes);
// A whole results.sqlite: every mission, network and file of it is read.
void FuzzStore(std::string_view bytes);

}  // namespace ed3r
