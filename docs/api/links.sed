# Links to files outside the reference become text.
s|\[([^]]*)\]\(\.\.?/[^)]*\)|\1|g
# So do links to other pages of docs and to sections, whose names Doxygen does not know.
s|\[([^]]*)\]\([^):]*\.md(#[^)]*)?\)|\1|g
s|\[([^]]*)\]\(#[^)]*\)|\1|g
