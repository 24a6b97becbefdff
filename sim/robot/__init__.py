"""The PeopleBot: body, wheels, encoders, sonars, settings and how it looks."""
