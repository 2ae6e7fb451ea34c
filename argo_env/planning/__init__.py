"""What plans are made with on a site: its catalogue, travel times, and generated sites."""
