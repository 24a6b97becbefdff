"""The PeopleBot: wheels, encoders, sonars and how it looks."""
