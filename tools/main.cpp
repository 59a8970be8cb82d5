#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <new>

#include "apertura/runtime/asset/error.h"
#include "tools/commands.h"
#include "tools/terminal.h"

namespace {

int fail(int code, const std::string& message) {
    std::fprintf(stderr, "apertura: %s\n", apertura::printable(message).c_str());
    return code;
}

// Standard output that could not be written is a failure too.
int finish(int code) {
    std::cout.flush();  // CLI11 prints help there
    if (std::fflush(stdout) == 0 && !std::ferror(stdout) && std::cout) return code;
    return code == 0 ? fail(1, std::string("standard output: cannot be written: ") + std::strerror(errno)) : code;
}

}  // namespace

// Exit codes: 0 done, 1 the work failed, 2 wrong use, 130 stopped by the user.
int main(int argc, char** argv) {
    CLI::App program{"Ambient aperture lighting from four spherical-harmonics coefficients", "apertura"};
    program.set_version_flag("--version", "apertura " APERTURA_VERSION);
    program.require_subcommand(1);
    try {
        apertura::addBakeCommand(program);
        apertura::addInfoCommand(program);
        apertura::addRenderCommand(program);
        apertura::addCompareCommand(program);
        apertura::addChartCommand(program);
        apertura::addStabilityCommand(program);
        apertura::addHorizonCommand(program);
        apertura::addViewCommand(program);
        apertura::catchInterrupts();
        std::signal(SIGXFSZ, SIG_IGN);  // too large a file is then an error of write()
        const auto verbs = program.get_subcommands([](const CLI::App*) { return true; });
        if (argc > 1 && argv[1][0] != '-'
            && std::none_of(verbs.begin(), verbs.end(), [&](const CLI::App* verb) { return verb->get_name() == argv[1]; }))
            return fail(2, std::string("there is no verb '") + argv[1] + "' (see apertura --help)");
        program.parse(argc, argv);
        return finish(0);
    } catch (const CLI::Success& help) {
        return finish(program.exit(help));
    } catch (const CLI::ParseError& error) {
        std::string verb;
        for (const CLI::App* parsed : program.get_subcommands()) verb += parsed->get_name() + " ";
        return fail(2, std::string(error.what()) + " (see apertura " + verb + "--help)");
    } catch (const apertura::Cancelled&) {
        return fail(130, "stopped; what was not finished was not written");
    } catch (const std::bad_alloc&) {
        return fail(1, "not enough memory");
    } catch (const std::exception& error) {
        return fail(1, error.what());
    }
}
