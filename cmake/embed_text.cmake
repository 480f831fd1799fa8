# Writes a C++ file that holds text files as string literals, behind a function of the namespace taut:
#   cmake -DOUTPUT=viewer_sources.cpp -DFUNCTION=viewer_texts -DHEADER=its.h -DFILES=a.js|b.css -P embed_text.cmake
string(REPLACE "|" ";" FILES "${FILES}")
set(code "#include \"${HEADER}\"\n\nnamespace taut {\n\nstd::span<const EmbeddedText> ${FUNCTION}() {\n  static constexpr EmbeddedText texts[] = {\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} text)
  string(APPEND code "    {\"${name}\", R\"_text_(${text})_text_\"},\n")
endforeach()
string(APPEND code "  };\n  return texts;\n}\n\n}  // namespace taut\n")
file(WRITE ${OUTPUT} "${code}")
