"""What formats of whole scenes share: names of takes, times of keys, bind poses, and the take of posed joints."""
