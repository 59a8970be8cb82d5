#include "tools/commands.h"
namespace apertura {
void addRenderCommand(CLI::App&) {}
}  // namespace apertura
