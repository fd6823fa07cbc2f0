# Links to files outside the reference become text.
s|\[([^]]*)\]\(\.\.?/[^)]*\)|\1|g
