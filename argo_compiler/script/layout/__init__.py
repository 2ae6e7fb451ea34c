"""Lines of a script: which are steps, fields, rows of tables, headings, or furniture."""
