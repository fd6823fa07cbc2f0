# Ordinary comments become comments of Doxygen: the block at the top describes the file, a comment behind a declaration
# belongs to it, and a comment on lines of its own belongs to the next declaration.
1d
2,/^#ifndef/{
  2s|^// |/// \\file\n/// |
  s|^//( .*)?$|///\1|
}
s|^( *)//( .*)?$|\1///\2|
s|([;,{})]) +// |\1  ///< |
