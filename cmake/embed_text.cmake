# Writes a C++ file that holds text files as string literals:
#   cmake -DOUTPUT=viewer_sources.cpp -DFILES=a.js|b.css -P embed_text.cmake
string(REPLACE "|" ";" FILES "${FILES}")
set(code "#include \"scenes/export/viewer_sources.h\"\n\nnamespace taut {\n\nstd::string_view viewer_source(std::string_view name) {\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} text)
  string(APPEND code "  if (name == \"${name}\") return R\"_text_(${text})_text_\";\n")
endforeach()
string(APPEND code "  return {};\n}\n\n}  // namespace taut\n")
file(WRITE ${OUTPUT} "${code}")
