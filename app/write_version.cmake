# cmake -Dgit=PROGRAM -Dproject=FOLDER -Dsource=FILE -P write_version.cmake: writes the source of
# version_with_commit(). `git` is empty when the project is not a Git repository.
cmake_minimum_required(VERSION 3.25)
set(commit "")
if(git)
  execute_process(COMMAND ${git} -C ${project} rev-parse --short=7 HEAD
    OUTPUT_VARIABLE commit ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
if(commit)
  set(commit " (${commit})")
endif()
file(WRITE ${source} "#include \"app/version.h\"

std::string spoonbill::version_with_commit() {
  return std::string(version_number) + \"${commit}\";
}
")
