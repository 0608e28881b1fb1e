"""The build files of a package: what `cmake -B build && cmake --build build` makes has the flags of
`verification.json`."""

from __future__ import annotations

from irb2400_ctrl.codegen.targets import FLAGS, LINK_FLAGS, START_UP_FLAGS, Target
from irb2400_ctrl.codegen.toolchain import EXACT_FLAGS


def build_files(name: str, target: Target | None) -> dict[str, str]:
    """File name -> text: CMakeLists.txt, and for a processor its toolchain file."""
    files = {"CMakeLists.txt": cmake(name, target)}
    if target is not None:
        files[f"{target.name}.cmake"] = _toolchain_file(target)
    return files


def cmake(name: str, target: Target | None = None) -> str:
    """Library and example, for a processor also the firmware; `-D<NAME>_SINGLE=0` chooses
    double."""
    upper = name.upper()
    chosen = "" if target is None else _choose_processor(upper, target)
    verified = "" if target is None else _verified_flags(upper, target)
    image = "" if target is None else _firmware(name)
    host = " ".join(EXACT_FLAGS)
    return f"""\
cmake_minimum_required(VERSION 3.13)
{chosen}project({name} C)
# as verified, unless another build is asked for
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()

add_library({name} STATIC {name}.c)
target_include_directories({name} PUBLIC ${{CMAKE_CURRENT_SOURCE_DIR}})
set_target_properties({name} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
if(DEFINED {upper}_SINGLE)
  target_compile_definitions({name} PUBLIC {upper}_SINGLE=${{{upper}_SINGLE}})
endif()
# the flags of verification.json; the same bits on every machine (no fused multiply-add), roots in
# hardware (no errno)
set({upper}_FLAGS {host})
{verified}if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
  if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    list(FILTER {upper}_FLAGS EXCLUDE REGEX "^-O")
  endif()
  target_compile_options({name} PRIVATE ${{{upper}_FLAGS}})
  target_compile_options({name} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion)
endif()
if(CMAKE_CROSSCOMPILING AND CMAKE_C_COMPILER_ID STREQUAL "GNU")
  # the constant that says where the code comes from stays in flash
  target_link_libraries({name} INTERFACE -Wl,-u,{name}_provenance)
endif()

if(NOT CMAKE_CROSSCOMPILING)
  add_executable({name}_example main.c)
  target_link_libraries({name}_example {name})
endif()
{image}"""


def _choose_processor(upper: str, target: Target) -> str:
    return f"""\
# built for the {target.name}, unless another toolchain or -D{upper}_ON_HOST=1 is given
if(CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR AND NOT CMAKE_TOOLCHAIN_FILE
    AND NOT {upper}_ON_HOST)
  set(CMAKE_TOOLCHAIN_FILE "${{CMAKE_CURRENT_SOURCE_DIR}}/{target.name}.cmake")
endif()
"""


def _verified_flags(upper: str, target: Target) -> str:
    return f"""\
if(CMAKE_CROSSCOMPILING)
  set({upper}_FLAGS {" ".join((*target.flags, *FLAGS))})
endif()
"""


def _firmware(name: str) -> str:
    upper = name.upper()
    return f"""
# the image that was verified: start-up code, vector table, the step in the tick's handler
if(CMAKE_CROSSCOMPILING AND CMAKE_C_COMPILER_ID STREQUAL "GNU")
  add_executable({name}_firmware firmware/firmware.c)
  set_target_properties({name}_firmware PROPERTIES OUTPUT_NAME firmware SUFFIX .elf)
  target_compile_options({name}_firmware PRIVATE ${{{upper}_FLAGS}} {" ".join(START_UP_FLAGS)})
  target_link_libraries({name}_firmware {name} ${{{upper}_FLAGS}} {" ".join(LINK_FLAGS)}
    -T${{CMAKE_CURRENT_SOURCE_DIR}}/firmware/firmware.ld -lgcc)
endif()
"""


def _toolchain_file(target: Target) -> str:
    return f"""\
# {target.name} with Arm's GNU toolchain
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_C_FLAGS_INIT "{" ".join(target.architecture)} -mthumb -mfloat-abi=hard")
# a bare machine links nothing by itself
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
"""
