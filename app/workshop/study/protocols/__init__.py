"""What a study is: its protocol, orders, goals and questionnaires."""
