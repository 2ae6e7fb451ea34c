"""Ways to an assistant: a command, or an endpoint that speaks the chat-completions interface."""
